#include "api/devices.h"

#include <fstream>
#include <thread>

#include "api/device_record.h"
#include "api/device_test.h"
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

DeviceInfo cpuInfo() {
  return {.id = "cpu",
          .name = processorName(),
          .type = DeviceType::Cpu,
          .threads = std::thread::hardware_concurrency(),
          .memory = memoryLeft()};
}

bool isRefused(const DeviceInfo& device) {
  return device.test == DeviceTestState::Failed || device.test == DeviceTestState::Unfinished;
}

/// Returns whether the device "auto" may be this GPU.
bool mayBeAutomatic(const DeviceInfo& gpu) {
  return gpu.problem.empty() && gpu.type != DeviceType::Software;
}

void addGpus(DeviceList& list) {
  for (DeviceInfo& gpu : gpuPlugIn()->list()) {
    const DeviceRecord record = readRecord(gpu);
    gpu.test = record.state;
    gpu.testProblem = record.problem;
    const size_t number = list.devices.size();
    if (gpu.problem.empty() && (!list.vulkanDefault || gpu.type < list.devices[*list.vulkanDefault].type))
      list.vulkanDefault = number;
    list.devices.push_back(std::move(gpu));
  }
}

/// Returns the index of the device that "auto" takes; 0 is the CPU.
size_t automaticOf(const std::vector<DeviceInfo>& devices) {
  size_t best = 0;
  for (size_t d = 1; d < devices.size(); ++d)
    if (mayBeAutomatic(devices[d]) && !isRefused(devices[d]) &&
        (best == 0 || devices[d].type < devices[best].type))
      best = d;
  return best;
}

}  // namespace

DeviceList devices() {
  DeviceList list;
  list.devices.push_back(cpuInfo());
  try {
    if (gpuPlugIn())
      addGpus(list);
    else
      list.note = "this program has no GPU backend; link raymap::vulkan, built with RAYMAP_VULKAN=ON";
  } catch (const Error& error) {
    list.note = error.what();
  }
  list.devices[automaticOf(list.devices)].chosenByAuto = true;
  return list;
}

namespace {

/// Returns " cpu vulkan:0".
std::string namesOf(const DeviceList& list) {
  std::string names;
  for (const DeviceInfo& device : list.devices) names.append(1, ' ').append(device.id);
  return names;
}

void requireUsable(const DeviceList& list, size_t number, const std::string& name) {
  if (number >= list.devices.size())
    throw Error(ErrorCode::Unsupported, "there is no device " + name +
                                            (list.note.empty() ? "" : ": " + list.note) + "; use one of" +
                                            namesOf(list));
  const DeviceInfo& device = list.devices[number];
  if (!device.problem.empty())
    throw Error(ErrorCode::Unsupported, name + " (" + device.name + ") cannot be used: " + device.problem);
}

DeviceName parse(const std::string& name) {
  if (const std::optional<DeviceName> asked = parseDeviceName(name)) return *asked;
  throw Error(ErrorCode::Usage, "there is no device '" + name + "'; use auto, cpu, vulkan or vulkan:K");
}

/// Returns the index in the list of a device that is not the CPU.
size_t indexOf(const DeviceName& asked, const DeviceList& list, const std::string& name) {
  const size_t index = asked.index ? *asked.index + 1 : list.vulkanDefault.value_or(list.devices.size());
  requireUsable(list, index, name);
  return index;
}

bool mayHaveGpu() {
  return gpuPlugIn() && gpuPlugIn()->mayHaveGpu();
}

/// Calls `warn` with the reason why none of the GPUs is used.
void warnOfRefused(const DeviceList& list, const WarningCallback& warn) {
  for (const DeviceInfo& gpu : list.devices)
    if (warn && mayBeAutomatic(gpu) && isRefused(gpu))
      warn({WarningCode::DeviceRefused,
            "the CPU is used instead of the GPU: " + reasonAgainst(gpu) + "; test it again to use it",
            {.device = gpu.id}});
}

std::optional<size_t> chooseAutomatic(const MachineOptions& machine) {
  for (;;) {
    const DeviceList list = devices();
    const size_t automatic = automaticOf(list.devices);
    if (automatic == 0) {
      warnOfRefused(list, machine.warn);
      return std::nullopt;
    }
    const size_t number = automatic - 1;
    if (testOnce(list.devices[automatic], number, machine.progress) == DeviceTestState::Passed) return number;
  }
}

}  // namespace

std::optional<size_t> chooseDevice(const MachineOptions& machine) {
  const DeviceName asked = parse(machine.device);
  if (asked.kind == DeviceName::Kind::Cpu) return std::nullopt;
  if (asked.kind == DeviceName::Kind::Auto) return mayHaveGpu() ? chooseAutomatic(machine) : std::nullopt;
  return indexOf(asked, devices(), machine.device) - 1;
}

std::string deviceToTest() {
  if (!mayHaveGpu()) return {};
  const DeviceList list = devices();
  const size_t automatic = automaticOf(list.devices);
  const DeviceInfo& device = list.devices[automatic];
  return automatic != 0 && device.test == DeviceTestState::Untested ? device.id : "";
}

DeviceTest testDevice(const std::string& id, const MachineOptions& machine) {
  const DeviceName asked = parse(id);
  if (asked.kind != DeviceName::Kind::Vulkan)
    throw Error(ErrorCode::Usage, "'" + id + "' is not the name of a GPU; use vulkan or vulkan:K");
  const DeviceList list = devices();
  const size_t index = indexOf(asked, list, id);
  return testGpu(list.devices[index], index - 1, machine.progress);
}

bool isOfTheDevice(const Error& error) {
  return error.code() != ErrorCode::Input && error.code() != ErrorCode::Usage &&
         error.code() != ErrorCode::Cancelled;
}

GpuDevice* ChosenDevice::open(const MachineOptions& machine) {
  if (name_ != machine.device) {
    close();
    number_ = chooseDevice(machine);
    name_ = machine.device;
  }
  if (number_ && !gpu_) gpu_ = gpuPlugIn()->open(*number_);
  return gpu_.get();
}

void ChosenDevice::close() {
  gpu_.reset();
  name_.reset();
  number_.reset();
}

}  // namespace raymap
