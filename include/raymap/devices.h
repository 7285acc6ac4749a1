#pragma once

#include <raymap/export.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace raymap {

/// Kinds of devices, in the order in which the device name "vulkan" prefers them; the CPU stands apart.
enum class DeviceType { Discrete, Integrated, Virtual, Other, Software, Cpu };

/// A device that can compute fields.
struct DeviceInfo {
  std::string id = {};    ///< Value for `Options::device`: "cpu", "vulkan:0", "vulkan:1", …
  std::string name = {};  ///< Name of the processor or GPU.
  DeviceType type = DeviceType::Other;
  std::string driver = {};    ///< Name and version of the driver; empty for the CPU.
  unsigned threads = 0;       ///< Number of hardware threads of the CPU; 0 for others.
  uint64_t memory = 0;        ///< Bytes of its largest heap; for the CPU, bytes available now.
  uint32_t sharedMemory = 0;  ///< Bytes of shared memory per work group; 0 for the CPU.
  std::string problem = {};   ///< Reason why it cannot be used; empty if it can.
};

/// All devices of this machine.
struct DeviceList {
  std::vector<DeviceInfo> devices = {};  ///< The CPU first, then Vulkan's devices in its order.
  size_t automatic = 0;                  ///< Index of the device that "auto" takes.
  std::optional<size_t> best = {};       ///< Index of the one that "vulkan" takes; none if none is usable.
  std::string note = {};                 ///< Reason why there is no Vulkan device; empty if there is one.
};

/// Returns all values that `Options::device` accepts, with what is behind them. Asks every Vulkan driver,
/// which can take a second.
RAYMAP_API DeviceList devices();

}  // namespace raymap
