#include "vulkan/device/features.h"

namespace raymap::vulkan {

namespace {

/// Feature structs of the caller.
struct FeatureStructs {
  VkPhysicalDeviceFeatures& v10;
  VkPhysicalDeviceVulkan12Features& v12;
  VkPhysicalDeviceVulkan13Features& v13;
};

struct Required {
  const char* name;
  VkBool32& (*in)(const FeatureStructs& features);
};

constexpr Required kRequired[] = {
    // For predicates and monotone keys.
    {"shaderFloat64", [](const FeatureStructs& f) -> VkBool32& { return f.v10.shaderFloat64; }},
    {"shaderInt64", [](const FeatureStructs& f) -> VkBool32& { return f.v10.shaderInt64; }},
    // For access to memory by address.
    {"bufferDeviceAddress", [](const FeatureStructs& f) -> VkBool32& { return f.v12.bufferDeviceAddress; }},
    {"scalarBlockLayout", [](const FeatureStructs& f) -> VkBool32& { return f.v12.scalarBlockLayout; }},
    // For barriers, work group sizes chosen when a pipeline is made, and subgroups without idle lanes.
    {"synchronization2", [](const FeatureStructs& f) -> VkBool32& { return f.v13.synchronization2; }},
    {"maintenance4", [](const FeatureStructs& f) -> VkBool32& { return f.v13.maintenance4; }},
    {"computeFullSubgroups", [](const FeatureStructs& f) -> VkBool32& { return f.v13.computeFullSubgroups; }},
    {"subgroupSizeControl", [](const FeatureStructs& f) -> VkBool32& { return f.v13.subgroupSizeControl; }},
};

constexpr VkSubgroupFeatureFlags kSubgroupOperations =
    VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_ARITHMETIC_BIT | VK_SUBGROUP_FEATURE_BALLOT_BIT;

bool hasSubgroupOperations(VkPhysicalDevice device) {
  VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v11};
  vkGetPhysicalDeviceProperties2(device, &properties);
  return (v11.subgroupSupportedOperations & kSubgroupOperations) == kSubgroupOperations &&
         (v11.subgroupSupportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0;
}

}  // namespace

void requireFeatures(VkPhysicalDeviceFeatures& v10, VkPhysicalDeviceVulkan12Features& v12,
                     VkPhysicalDeviceVulkan13Features& v13) {
  for (const Required& required : kRequired) required.in({v10, v12, v13}) = VK_TRUE;
}

std::string missingFeatures(VkPhysicalDevice device) {
  Features features;
  vkGetPhysicalDeviceFeatures2(device, &features.v10);
  std::string missing;
  const auto add = [&missing](const char* name) {
    missing += (missing.empty() ? "" : ", ") + std::string(name);
  };
  for (const Required& required : kRequired)
    if (required.in({features.v10.features, features.v12, features.v13}) == VK_FALSE) add(required.name);
  if (!hasSubgroupOperations(device)) add("subgroup arithmetic and ballot in compute shaders");
  return missing;
}

}  // namespace raymap::vulkan
