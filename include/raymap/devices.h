#pragma once

#include <raymap/device_info.h>
#include <raymap/export.h>
#include <raymap/machine.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace raymap {

/// All devices of this machine.
struct DeviceList {
  std::vector<DeviceInfo> devices = {};  ///< The CPU first, then Vulkan's devices in its order.
  std::optional<size_t> vulkanDefault =
      {};                 ///< Index of the one that "vulkan" takes; none if none is usable.
  std::string note = {};  ///< Reason why there is no Vulkan device; empty if there is one.
};

/// Returns all values that `MachineOptions::device` accepts, with what is behind them. Asks every Vulkan
/// driver, which can take a second.
RAYMAP_API DeviceList devices();

/// Returns the id of the GPU that the device "auto" would test before its first use; empty if there is none.
/// A driver may end the process that tests it. A program can avoid that: it runs `raymap devices --test ID`
/// first, a process of its own.
RAYMAP_API std::string deviceToTest();

/// Result of a test of a GPU.
struct DeviceTest {
  DeviceInfo device = {};                ///< The GPU that was tested.
  std::vector<DeviceCheck> checks = {};  ///< Those that ended, in their order.
  std::string problem = {};              ///< The first check that failed, and its difference; empty if none.
  double milliseconds = 0.0;             ///< Time of the whole test.
  bool hangs = false;  ///< Whether a check did not end. Its thread still runs and holds the device.
};

/// Runs small versions of every stage and of whole fields on a GPU, and compares them with the CPU, up to the
/// first that fails. Writes the result to the user's cache folder, from where `devices` and the device "auto"
/// read it.
///
/// The folder is the environment variable RAYMAP_CACHE, else $XDG_CACHE_HOME/raymap, else ~/.cache/raymap.
/// If it is off (RAYMAP_CACHE=off) or cannot be written, this process remembers the result.
///
/// `id` is that of a device in `devices`, or "vulkan" for the best one. Only `progress` of `machine` is used.
/// Throws `Error`: Usage for a name that
/// is not that of a GPU, Unsupported if there is no such device or another thread or process tests it now,
/// Cancelled.
RAYMAP_API DeviceTest testDevice(const std::string& id, const MachineOptions& machine = {});

}  // namespace raymap
