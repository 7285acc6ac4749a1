#include "devices.h"

#include <raymap/error.h>

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
  const auto best = vulkan::bestDevice(found);
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

}  // namespace raymap
