#pragma once

#include <string>

#include "vulkan/device/api.h"
// After Vulkan's declarations, as it asks.
#include <raymap/vulkan.h>

namespace raymap::vulkan {

/// The features of Vulkan 1.3, chained.
struct Features {
  Features() = default;
  Features(const Features&) = delete;
  Features& operator=(const Features&) = delete;

  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &v13};
  VkPhysicalDeviceFeatures2 v10{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &v12};
};

/// Switches on what the shaders need.
inline void setRequired(Features& features) {
  requireFeatures(features.v10.features, features.v12, features.v13);
}
/// Names what the shaders need and the device lacks; empty if nothing.
std::string missingFeatures(VkPhysicalDevice device);

}  // namespace raymap::vulkan
