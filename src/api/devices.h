#pragma once

#include <raymap/devices.h>
#include <raymap/error.h>
#include <raymap/machine.h>

#include <memory>
#include <optional>
#include <string>

#include "method/gpu_plug_in.h"

namespace raymap {

/// Returns the number of the GPU that `machine.device` names; none for the CPU. `auto` asks drivers only on
/// machines that have a GPU, tests a GPU before its first use, and calls `warn` with the reason if it takes
/// the CPU because GPUs failed. Throws `Error`: Usage for a name that is none, Unsupported if there is no
/// such device, Cancelled.
std::optional<size_t> chooseDevice(const MachineOptions& machine);

/// Returns whether another device may succeed where this error stopped one: not if the input or the options
/// are at fault, or the user cancelled.
bool isOfTheDevice(const Error& error);

/// The device that a caller's runs use. Chosen and opened once, for as long as the name stays the same and
/// the device works.
class ChosenDevice {
 public:
  /// Calls `work(device, number)` if `machine.device` means a GPU. Returns false if the CPU has to do the
  /// work: the name means the CPU, or the GPU that `auto` chose failed. Then it warns with the reason.
  /// `machine.progress` is that of the test of a new GPU.
  template <class Work>
  bool run(const MachineOptions& machine, Work&& work) {
    try {
      GpuDevice* const device = open(machine);
      if (device) work(*device, *number_);
      return device != nullptr;
    } catch (const Error& error) {
      if (!isOfTheDevice(error)) throw;  // The device is as good as before.
      const std::string used = number_ ? "vulkan:" + std::to_string(*number_) : "";
      close();
      if (machine.device != "auto") throw;
      if (machine.warn)
        machine.warn({WarningCode::DeviceFailed,
                      std::string("the CPU was used instead of the GPU: ") + error.what(),
                      {.device = used}});
      return false;
    } catch (...) {
      close();
      throw;
    }
  }

 private:
  /// Returns null for the CPU.
  GpuDevice* open(const MachineOptions& machine);
  void close();

  std::optional<std::string> name_;  ///< Name that was chosen last.
  std::optional<size_t> number_;     ///< None for the CPU.
  std::unique_ptr<GpuDevice> gpu_;
};

}  // namespace raymap
