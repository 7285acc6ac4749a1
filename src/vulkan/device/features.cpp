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
    // For predicates, and for double precision in software.
    {"shaderInt64", [](const FeatureStructs& f) -> VkBool32& { return f.v10.shaderInt64; }},
    // For access to memory by address.
    {"bufferDeviceAddress", [](const FeatureStructs& f) -> VkBool32& { return f.v12.bufferDeviceAddress; }},
    {"scalarBlockLayout", [](const FeatureStructs& f) -> VkBool32& { return f.v12.scalarBlockLayout; }},
    // For barriers, work group sizes chosen when a pipeline is made, and subgroups without idle lanes.
    {"synchronization2", [](const FeatureStructs& f) -> VkBool32& { return f.v13.synchronization2; }},
    {"maintenance4", [](const FeatureStructs& f) -> VkBool32& { return f.v13.maintenance4; }},
    {"computeFullSubgroups", [](const FeatureStructs& f) -> VkBool32& { return f.v13.computeFullSubgroups; }},
};

struct SubgroupOperation {
  const char* name;
  VkSubgroupFeatureFlagBits bit;
};

constexpr SubgroupOperation kSubgroupOperations[] = {
    {"basic", VK_SUBGROUP_FEATURE_BASIC_BIT},
    {"arithmetic", VK_SUBGROUP_FEATURE_ARITHMETIC_BIT},
    {"ballot", VK_SUBGROUP_FEATURE_BALLOT_BIT},
};

}  // namespace

void requireFeatures(VkPhysicalDeviceFeatures& v10, VkPhysicalDeviceVulkan12Features& v12,
                     VkPhysicalDeviceVulkan13Features& v13) {
  for (const Required& required : kRequired) required.in({v10, v12, v13}) = VK_TRUE;
}

VkSubgroupFeatureFlags requiredSubgroupOperations() {
  VkSubgroupFeatureFlags all = 0;
  for (const SubgroupOperation& operation : kSubgroupOperations) all |= operation.bit;
  return all;
}

std::vector<std::string> missingSubgroupOperations(VkSubgroupFeatureFlags operations,
                                                   VkShaderStageFlags stages) {
  const bool inCompute = (stages & VK_SHADER_STAGE_COMPUTE_BIT) != 0;
  std::vector<std::string> missing;
  for (const SubgroupOperation& operation : kSubgroupOperations)
    if (!inCompute || (operations & operation.bit) == 0)
      missing.push_back("subgroup operations '" + std::string(operation.name) + "' in compute shaders");
  return missing;
}

std::string missingFeatures(VkPhysicalDevice device) {
  Features features;
  vkGetPhysicalDeviceFeatures2(device, &features.v10);
  std::string missing;
  const auto add = [&missing](const std::string& name) { missing += (missing.empty() ? "" : ", ") + name; };
  for (const Required& required : kRequired)
    if (required.in({features.v10.features, features.v12, features.v13}) == VK_FALSE) add(required.name);
  VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v11};
  vkGetPhysicalDeviceProperties2(device, &properties);
  for (const std::string& name :
       missingSubgroupOperations(v11.subgroupSupportedOperations, v11.subgroupSupportedStages))
    add(name);
  return missing;
}

}  // namespace raymap::vulkan
