#include <raymap/names.h>

#include <cstdio>
#include <iostream>

#include "commands.h"
#include "report.h"

namespace raymap {

namespace {

constexpr const char* kFooter = R"(Examples:
  raymap devices
  raymap devices --json | jq -r .auto

'auto' marks the default device: a GPU if there is one, else the CPU. A software rasterizer is used only
if --device names it.)";

void print(const DeviceList& list) {
  for (size_t i = 0; i < list.devices.size(); ++i) {
    const DeviceInfo& device = list.devices[i];
    std::printf("%-10s %-5s %s\n", device.id.c_str(), i == list.automatic ? "auto" : "", device.name.c_str());
    if (device.threads > 0)
      std::printf("%16s %u threads, %s of memory left\n", "", device.threads,
                  sizeText(device.memory).c_str());
    else
      std::printf("%16s %s, %s of memory, %s shared by a work group, driver %s\n", "",
                  std::string(name(device.type)).c_str(), sizeText(device.memory).c_str(),
                  sizeText(device.sharedMemory).c_str(), device.driver.c_str());
    if (!device.problem.empty()) std::printf("%16s cannot be used: %s\n", "", device.problem.c_str());
  }
  if (!list.note.empty()) std::printf("no GPU: %s\n", list.note.c_str());
}

Json toJson(const DeviceList& list) {
  Json all = Json::array();
  for (const DeviceInfo& device : list.devices) {
    Json json{{"id", device.id},
              {"name", device.name},
              {"type", name(device.type)},
              {"memory_bytes", device.memory}};
    if (device.threads > 0) {
      json["threads"] = device.threads;
    } else {
      json["shared_memory_bytes"] = device.sharedMemory;
      json["driver"] = device.driver;
    }
    json["usable"] = device.problem.empty();
    if (!device.problem.empty()) json["problem"] = device.problem;
    all.push_back(json);
  }
  Json json{{"auto", list.devices[list.automatic].id}, {"devices", all}};
  if (!list.note.empty()) json["note"] = list.note;
  return json;
}

}  // namespace

void addDevices(CLI::App& app) {
  CLI::App* command = app.add_subcommand("devices", "List the devices that can compute a field");
  const auto isJson = std::make_shared<bool>(false);
  command->add_flag("--json", *isJson, "Print JSON");
  command->footer(kFooter);
  command->callback([isJson] {
    const DeviceList list = devices();
    if (*isJson)
      std::cout << toJson(list).dump(2) << "\n";
    else
      print(list);
  });
}

}  // namespace raymap
