#pragma once

#include <raymap/callbacks.h>
#include <raymap/devices.h>
#include <raymap/error.h>

#include <memory>
#include <optional>
#include <string>

#include "method/gpu_plug_in.h"

namespace raymap {

/// Returns the number of the GPU that `Options::device` names; none for the CPU. `auto` asks drivers only on
/// machines that have a GPU. Throws `Error`: Usage for a name that is none, Unsupported if there is no such
/// device.
std::optional<size_t> chooseDevice(const std::string& name);

/// Returns whether another device may succeed where this error stopped one: not if the input or the options
/// are at fault, or the user cancelled.
bool isOfTheDevice(const Error& error);

/// The device that a caller's runs use. Chosen and opened once, for as long as the name stays the same and it
/// works.
class ChosenDevice {
 public:
  /// Calls `onGpu(device, index)` if `name` means a GPU, else `onCpu()`. If a GPU that `auto` chose fails,
  /// calls `warn` with the reason and falls back to `onCpu`.
  template <class OnGpu, class OnCpu>
  void run(const std::string& name, const WarningCallback& warn, OnGpu&& onGpu, OnCpu&& onCpu) {
    try {
      if (GpuDevice* device = open(name)) return onGpu(*device, *index_);
    } catch (const Error& error) {
      if (!isOfTheDevice(error)) throw;  // The device is as good as before.
      close();
      if (name != "auto") throw;
      if (warn) warn(std::string("the GPU was not used, the CPU instead: ") + error.what());
    } catch (...) {
      close();
      throw;
    }
    onCpu();
  }

 private:
  /// Returns null for the CPU.
  GpuDevice* open(const std::string& name);
  void close();

  std::optional<std::string> name_;  ///< The last one chosen.
  std::optional<size_t> index_;
  std::unique_ptr<GpuDevice> gpu_;
};

}  // namespace raymap
