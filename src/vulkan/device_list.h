#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "api.h"

namespace raymap::vulkan {

/// In order of preference.
enum class DeviceType { Discrete, Integrated, Virtual, Other, Software };

struct DeviceInfo {
  std::string name;
  DeviceType type = DeviceType::Other;
  std::string driver;         ///< Its name and version.
  uint64_t memory = 0;        ///< Bytes of its largest own heap.
  uint32_t sharedMemory = 0;  ///< Bytes a work group may share.
  std::string problem;        ///< Why it cannot be used; empty if it can.
};

/// The devices in the loader's order: "vulkan:K" is element K. Throws `Error(Unsupported)` if there is no
/// loader or no driver.
std::vector<DeviceInfo> listDevices();

/// The usable device to take if none is named: the first of the best type. None if none is usable.
std::optional<size_t> bestDevice(const std::vector<DeviceInfo>& devices);

/// Physical devices and what they are, in the same order.
std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance);
DeviceInfo describe(VkPhysicalDevice device);
/// The first queue family that computes; prefers one that does nothing else, so that graphics go on beside
/// it. None if there is none.
std::optional<uint32_t> computeFamily(VkPhysicalDevice device);

}  // namespace raymap::vulkan
