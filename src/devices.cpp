#include "devices.h"

#include <raymap/error.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <thread>

#include "memory.h"
#ifdef RAYMAP_VULKAN
#include "vulkan/device_list.h"
#endif

namespace raymap {

namespace {

/// "AMD EPYC 9B14", as the system calls it.
std::string processorName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "processor";
}

ComputeDevice cpu() {
  return {.id = "cpu",
          .name = processorName(),
          .type = "cpu",
          .threads = std::thread::hardware_concurrency(),
          .memory = availableMemory()};
}

#ifdef RAYMAP_VULKAN
const char* nameOf(vulkan::DeviceType type) {
  switch (type) {
    case vulkan::DeviceType::Discrete:
      return "discrete";
    case vulkan::DeviceType::Integrated:
      return "integrated";
    case vulkan::DeviceType::Virtual:
      return "virtual";
    case vulkan::DeviceType::Software:
      return "software";
    case vulkan::DeviceType::Other:
      break;
  }
  return "other";
}

void addVulkan(DeviceList& list) {
  const std::vector<vulkan::DeviceInfo> found = vulkan::listDevices();
  for (size_t k = 0; k < found.size(); ++k)
    list.devices.push_back({.id = "vulkan:" + std::to_string(k),
                            .name = found[k].name,
                            .type = nameOf(found[k].type),
                            .driver = found[k].driver,
                            .memory = found[k].memory,
                            .sharedMemory = found[k].sharedMemory,
                            .problem = found[k].problem});
  const std::optional<size_t> best = vulkan::bestDevice(found);
  if (best) list.best = *best + 1;
  if (best && found[*best].type != vulkan::DeviceType::Software) list.automatic = *best + 1;
}
#endif

}  // namespace

DeviceList listDevices() {
  DeviceList list;
  list.devices.push_back(cpu());
#ifdef RAYMAP_VULKAN
  try {
    addVulkan(list);
  } catch (const Error& error) {
    list.note = error.what();
  }
#else
  list.note = "built without Vulkan; build with RAYMAP_VULKAN=ON";
#endif
  return list;
}

namespace {

/// Whether the system shows a GPU at all: asking every driver takes much longer.
bool mayHaveGpu() {
  std::error_code ignored;
  for (const char* node : {"/dev/dri", "/dev/nvidiactl", "/dev/dxg"})
    if (std::filesystem::exists(node, ignored)) return true;
  return false;
}

void requireUsable(const DeviceList& list, size_t number, const std::string& name) {
  if (number >= list.devices.size())
    throw Error(ErrorCode::Unsupported, "there is no device " + name +
                                            (list.note.empty() ? "" : ": " + list.note) +
                                            "; `raymap devices` lists them");
  const ComputeDevice& device = list.devices[number];
  if (!device.problem.empty())
    throw Error(ErrorCode::Unsupported, name + " (" + device.name + ") cannot be used: " + device.problem);
}

}  // namespace

std::optional<size_t> chooseDevice(const std::string& name) {
  if (name == "cpu" || (name == "auto" && !mayHaveGpu())) return std::nullopt;
  const std::string prefix = "vulkan:";
  size_t index = 0;
  const bool isNumbered =
      name.starts_with(prefix) &&
      std::from_chars(name.data() + prefix.size(), name.data() + name.size(), index).ptr ==
          name.data() + name.size() &&
      name.size() > prefix.size();
  if (name != "auto" && name != "vulkan" && !isNumbered)
    throw Error(ErrorCode::Usage, "there is no device '" + name + "'; use auto, cpu, vulkan or vulkan:K");
  const DeviceList list = listDevices();
  if (name == "auto") return list.automatic == 0 ? std::nullopt : std::optional(list.automatic - 1);
  if (name == "vulkan") index = list.best ? *list.best - 1 : list.devices.size();
  requireUsable(list, index + 1, name);
  return index;
}

bool isOfTheDevice(const Error& error) {
  return error.code() != ErrorCode::Input && error.code() != ErrorCode::Usage &&
         error.code() != ErrorCode::Cancelled;
}

}  // namespace raymap
