#pragma once

#include <raymap/device_info.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "vulkan/device/api.h"

namespace raymap::vulkan {

/// Returns the devices in the loader's order: "vulkan:K" is element K. Throws `Error(Unsupported)` if there
/// is no loader or no driver.
std::vector<DeviceInfo> listDevices();

/// Returns the index of the default device: the first usable one of the best type. None if none is usable.
std::optional<size_t> bestDevice(const std::vector<DeviceInfo>& devices);

/// Returns the physical devices in the loader's order.
std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance);
DeviceInfo describe(VkPhysicalDevice device);
/// Returns the first queue family that computes; none if there is none. Prefers a family for compute alone,
/// so that graphics can run at the same time.
std::optional<uint32_t> computeFamily(VkPhysicalDevice device);

}  // namespace raymap::vulkan
