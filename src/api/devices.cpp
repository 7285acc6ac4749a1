#include "api/devices.h"

#include <fstream>
#include <thread>

#include "base/memory.h"
#include "method/device_name.h"

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

DeviceInfo cpu() {
  return {.id = "cpu",
          .name = processorName(),
          .type = DeviceType::Cpu,
          .threads = std::thread::hardware_concurrency(),
          .memory = availableMemory()};
}

void addGpus(DeviceList& list) {
  for (const DeviceInfo& gpu : gpuPlugIn()->list()) {
    const size_t number = list.devices.size();
    if (gpu.problem.empty() && (!list.best || gpu.type < list.devices[*list.best].type)) list.best = number;
    list.devices.push_back(gpu);
  }
  if (list.best && list.devices[*list.best].type != DeviceType::Software) list.automatic = *list.best;
}

}  // namespace

DeviceList devices() {
  DeviceList list;
  list.devices.push_back(cpu());
  if (!gpuPlugIn()) {
    list.note = "this program has no GPU backend; link raymap::vulkan, built with RAYMAP_VULKAN=ON";
    return list;
  }
  try {
    addGpus(list);
  } catch (const Error& error) {
    list.note = error.what();
  }
  return list;
}

namespace {

void requireUsable(const DeviceList& list, size_t number, const std::string& name) {
  if (number >= list.devices.size())
    throw Error(ErrorCode::Unsupported, "there is no device " + name +
                                            (list.note.empty() ? "" : ": " + list.note) +
                                            "; `raymap devices` lists them");
  const DeviceInfo& device = list.devices[number];
  if (!device.problem.empty())
    throw Error(ErrorCode::Unsupported, name + " (" + device.name + ") cannot be used: " + device.problem);
}

}  // namespace

std::optional<size_t> chooseDevice(const std::string& name) {
  const std::optional<DeviceName> asked = parseDeviceName(name);
  if (!asked)
    throw Error(ErrorCode::Usage, "there is no device '" + name + "'; use auto, cpu, vulkan or vulkan:K");
  const bool isAuto = asked->kind == DeviceName::Kind::Auto;
  if (asked->kind == DeviceName::Kind::Cpu || (isAuto && !(gpuPlugIn() && gpuPlugIn()->mayHaveGpu())))
    return std::nullopt;
  const DeviceList list = devices();
  if (isAuto) return list.automatic == 0 ? std::nullopt : std::optional(list.automatic - 1);
  const size_t number = asked->index ? *asked->index + 1 : list.best.value_or(list.devices.size());
  requireUsable(list, number, name);
  return number - 1;
}

bool isOfTheDevice(const Error& error) {
  return error.code() != ErrorCode::Input && error.code() != ErrorCode::Usage &&
         error.code() != ErrorCode::Cancelled;
}

GpuDevice* ChosenDevice::open(const std::string& name) {
  if (name_ != name) {
    close();
    number_ = chooseDevice(name);
    name_ = name;
  }
  if (number_ && !gpu_) gpu_ = gpuPlugIn()->open(*number_);
  return gpu_.get();
}

void ChosenDevice::close() {
  gpu_.reset();
  name_.reset();
}

}  // namespace raymap
