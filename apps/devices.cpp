#include <raymap/devices.h>
#include <raymap/error.h>
#include <raymap/json.h>
#include <raymap/names.h>
#include <raymap/version.h>

#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "commands.h"
#include "report.h"
#include "terminal.h"

namespace raymap {

namespace {

constexpr const char* kDevicesFooter = R"(Examples:
  raymap devices
  raymap devices --json | jq '.devices[] | select(.chosen_by_auto)'
  raymap devices --test                                 (every GPU)
  raymap devices --test vulkan:0

'auto' marks the default device: a GPU if there is one, else the CPU. A software rasterizer is used only
if --device names it. A GPU is tested before its first use by default: small versions of every stage and of
whole fields are compared with the CPU. The result is kept in the folder that the environment variable
RAYMAP_CACHE names, else $XDG_CACHE_HOME/raymap, else ~/.cache/raymap; RAYMAP_CACHE=off keeps nothing.

--test tests now. Its exit code is 0 if all passed, and 9 if one failed.)";

constexpr int kFailedTest = 9;

void print(const DeviceList& list) {
  for (const DeviceInfo& device : list.devices) {
    std::printf("%-10s %-5s %s\n", device.id.c_str(), device.chosenByAuto ? "auto" : "", device.name.c_str());
    if (device.threads > 0)
      std::printf("%16s %u threads, %s of memory left\n", "", device.threads,
                  sizeText(device.memory).c_str());
    else
      std::printf("%16s %s, %s of memory, %s shared by a work group, driver %s\n", "",
                  std::string(name(device.type)).c_str(), sizeText(device.memory).c_str(),
                  sizeText(device.sharedMemory).c_str(), device.driver.c_str());
    if (!device.problem.empty()) std::printf("%16s cannot be used: %s\n", "", device.problem.c_str());
    if (device.problem.empty() && device.threads == 0)
      std::printf("%16s test: %s%s%s\n", "", std::string(name(device.test)).c_str(),
                  device.testProblem.empty() ? "" : ", ", device.testProblem.c_str());
  }
  if (!list.note.empty()) std::printf("no GPU: %s\n", list.note.c_str());
}

void printHead(const DeviceInfo& device) {
  std::printf("raymap %s tests %s\n", version().text, device.id.c_str());
  std::printf("  device    %s, %s\n", device.name.c_str(), std::string(name(device.type)).c_str());
  std::printf("  driver    %s\n", device.driver.c_str());
  std::printf("  Vulkan    %s, subgroups of %u (%u to %u), %s shared by a work group\n",
              device.vulkanVersion.c_str(), device.subgroupSize, device.minSubgroupSize,
              device.maxSubgroupSize, sizeText(device.sharedMemory).c_str());
}

void print(const DeviceTest& test) {
  printHead(test.device);
  for (const DeviceCheck& check : test.checks) {
    std::printf("  %-26s%s %6.0f ms\n", check.name.c_str(), check.difference.empty() ? "passed" : "FAILED",
                check.milliseconds);
    if (!check.difference.empty()) std::printf("    %s\n", check.difference.c_str());
  }
  if (test.problem.empty())
    std::printf("passed %s in %.1f s\n", counted(test.checks.size(), "check").c_str(),
                1e-3 * test.milliseconds);
  else
    std::printf("FAILED in %s\n", test.problem.c_str());
}

/// Returns the devices to test: the one named, or every one that can be used.
std::vector<std::string> devicesToTest(const std::string& asked) {
  if (!asked.empty()) return {asked};
  std::vector<std::string> ids;
  const DeviceList list = devices();
  for (const DeviceInfo& device : list.devices)
    if (device.id != "cpu" && device.problem.empty()) ids.push_back(device.id);
  if (ids.empty())
    throw Error(ErrorCode::Unsupported,
                "there is no GPU to test" + (list.note.empty() ? "; see raymap devices" : ": " + list.note));
  return ids;
}

/// Ends the program if a test failed.
void testAll(const std::string& asked, bool isJson) {
  Json tests = Json::array();
  bool isPassed = true, hangs = false;
  for (const std::string& id : devicesToTest(asked)) {
    ProgressLine line;
    const DeviceTest test = testDevice(id, {.progress = line.callback()});
    line.clear();
    if (isJson)
      tests.push_back(toJson(test));
    else
      print(test);
    isPassed = isPassed && test.problem.empty();
    hangs = hangs || test.hangs;
  }
  if (isJson) std::cout << textOf({{"raymap", version().text}, {"tests", tests}});
  std::cout.flush();
  std::fflush(stdout);
  if (hangs) _exit(kFailedTest);  // An orderly end would wait for the driver.
  if (!isPassed) throw ExitCode(kFailedTest);
}

}  // namespace

void addDevices(Program& program) {
  Command& command =
      program.addCommand("devices", "List the devices that can compute a field", kDevicesFooter);
  const auto isJson = std::make_shared<bool>(false);
  addJsonOption(command, *isJson);
  const auto tested = std::make_shared<std::string>();
  addOptions(command, {{"--test", tested.get()}});
  command.run = [isJson, tested, &command] {
    silenceText();
    if (command.isGiven("--test")) {
      testAll(*tested, *isJson);
      return;
    }
    const DeviceList list = devices();
    if (*isJson)
      std::cout << textOf({{"devices", toJson(list.devices)}, {"note", list.note}});
    else
      print(list);
  };
}

}  // namespace raymap
