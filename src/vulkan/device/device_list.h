#pragma once

#include <raymap/devices.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "vulkan/device/api.h"

namespace raymap::vulkan {

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
