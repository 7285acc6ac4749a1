#pragma once

#include <string>
#include <vector>

#include "vulkan/device/api.h"
// raymap/vulkan.h must follow Vulkan's declarations.
#include <raymap/vulkan_device.h>

namespace raymap::vulkan {

/// Features of Vulkan 1.3, chained.
struct Features {
  Features() = default;
  Features(const Features&) = delete;
  Features& operator=(const Features&) = delete;

  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &v13};
  VkPhysicalDeviceFeatures2 v10{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &v12};
};

/// Enables the features that the shaders need.
inline void setRequired(Features& features) {
  requireFeatures(features.v10.features, features.v12, features.v13);
}
/// Returns the subgroup operations that the shaders need.
VkSubgroupFeatureFlags requiredSubgroupOperations();
/// Names those that a device lacks which has `operations` in the shaders of `stages`.
std::vector<std::string> missingSubgroupOperations(VkSubgroupFeatureFlags operations,
                                                   VkShaderStageFlags stages);
/// Names the features and limits that the shaders need and the device lacks; empty if none.
std::string missingFeatures(VkPhysicalDevice device);

}  // namespace raymap::vulkan
