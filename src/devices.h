#pragma once

#include <raymap/error.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raymap {

/// What can compute a field.
struct ComputeDevice {
  std::string id;  ///< "cpu", "vulkan:0", ...
  std::string name;
  std::string type;           ///< cpu, or a Vulkan device's: discrete, integrated, virtual, other, software.
  std::string driver;         ///< Its name and version; empty for the CPU.
  unsigned threads = 0;       ///< Of the CPU; 0 for others.
  uint64_t memory = 0;        ///< Bytes it has; for the CPU, those left.
  uint32_t sharedMemory = 0;  ///< Bytes a work group may share; 0 for the CPU.
  std::string problem;        ///< Why it cannot be used; empty if it can.
};

struct DeviceList {
  std::vector<ComputeDevice> devices;  ///< The CPU first, then Vulkan's in its order.
  size_t automatic = 0;                ///< What `auto` takes: a real GPU if one is usable, else the CPU.
  std::optional<size_t> best;          ///< Of Vulkan's devices, a driver in software included.
  std::string note;                    ///< Why there is no Vulkan device; empty if there is one.
};

DeviceList listDevices();

/// The Vulkan device that `Options::device` means; none for the CPU. `auto` looks for drivers only on
/// machines that have a GPU. Throws `Error`: Usage for a name that is none, Unsupported if there is no such
/// device.
std::optional<size_t> chooseDevice(const std::string& name);

/// Whether another device may do what this error stopped: not where the input is at fault, or the user.
bool isOfTheDevice(const Error& error);

/// `onGpu(index)` if there is an index, else `onCpu()`. A GPU that fails is told of by `warn` and the CPU
/// taken instead, if that is allowed and may help.
template <class OnGpu, class OnCpu>
void runOnChosen(std::optional<size_t> index, bool mayFallBack,
                 const std::function<void(std::string_view)>& warn, OnGpu&& onGpu, OnCpu&& onCpu) {
  if (!index) return onCpu();
  try {
    return onGpu(*index);
  } catch (const Error& error) {
    if (!mayFallBack || !isOfTheDevice(error)) throw;
    if (warn) warn(std::string("the GPU was not used, the CPU instead: ") + error.what());
  }
  onCpu();
}

/// On what the device's name says; only `auto` falls back.
template <class OnGpu, class OnCpu>
void runOnDevice(const std::string& name, const std::function<void(std::string_view)>& warn, OnGpu&& onGpu,
                 OnCpu&& onCpu) {
  runOnChosen(chooseDevice(name), name == "auto", warn, onGpu, onCpu);
}

}  // namespace raymap
