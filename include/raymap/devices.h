#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raymap {

/// Kind of a device, in the order in which `vulkan` prefers them; the CPU stands apart.
enum class DeviceType { Discrete, Integrated, Virtual, Other, Software, Cpu };

/// Something that computes fields.
struct DeviceInfo {
  std::string id;  ///< Value for `Options::device`: "cpu", "vulkan:0", "vulkan:1", …
  std::string name;
  DeviceType type = DeviceType::Other;
  std::string driver;         ///< Name and version of the driver; empty for the CPU.
  unsigned threads = 0;       ///< Hardware threads of the CPU; 0 for others.
  uint64_t memory = 0;        ///< Bytes of its largest heap; for the CPU, bytes available now.
  uint32_t sharedMemory = 0;  ///< Bytes of shared memory per work group; 0 for the CPU.
  std::string problem;        ///< Reason why it cannot be used; empty if it can.
};

/// All devices of this machine.
struct DeviceList {
  std::vector<DeviceInfo> devices;  ///< The CPU first, then Vulkan's devices in its order.
  size_t automatic = 0;             ///< Index of the device that `auto` takes.
  std::optional<size_t> best;       ///< Index of the one that `vulkan` takes; none if none is usable.
  std::string note;                 ///< Reason why there is no Vulkan device; empty if there is one.
};

/// Returns what `Options::device` accepts. Asks every Vulkan driver, which can take a second.
DeviceList devices();

}  // namespace raymap
