#include "features.h"

namespace raymap::vulkan {

namespace {

struct Required {
  const char* name;
  VkBool32& (*in)(Features& features);
};

constexpr Required kRequired[] = {
    // Predicates and monotone keys.
    {"shaderFloat64", [](Features& f) -> VkBool32& { return f.v10.features.shaderFloat64; }},
    {"shaderInt64", [](Features& f) -> VkBool32& { return f.v10.features.shaderInt64; }},
    // How shaders reach memory.
    {"bufferDeviceAddress", [](Features& f) -> VkBool32& { return f.v12.bufferDeviceAddress; }},
    {"scalarBlockLayout", [](Features& f) -> VkBool32& { return f.v12.scalarBlockLayout; }},
    // Barriers, sizes of work groups chosen when a pipeline is made, and subgroups without idle lanes.
    {"synchronization2", [](Features& f) -> VkBool32& { return f.v13.synchronization2; }},
    {"maintenance4", [](Features& f) -> VkBool32& { return f.v13.maintenance4; }},
    {"computeFullSubgroups", [](Features& f) -> VkBool32& { return f.v13.computeFullSubgroups; }},
    {"subgroupSizeControl", [](Features& f) -> VkBool32& { return f.v13.subgroupSizeControl; }},
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

void setRequired(Features& features) {
  for (const Required& required : kRequired) required.in(features) = VK_TRUE;
}

std::string missingFeatures(VkPhysicalDevice device) {
  Features features;
  vkGetPhysicalDeviceFeatures2(device, &features.v10);
  std::string missing;
  const auto add = [&missing](const char* name) {
    missing += (missing.empty() ? "" : ", ") + std::string(name);
  };
  for (const Required& required : kRequired)
    if (required.in(features) == VK_FALSE) add(required.name);
  if (!hasSubgroupOperations(device)) add("subgroup arithmetic and ballot in compute shaders");
  return missing;
}

}  // namespace raymap::vulkan
