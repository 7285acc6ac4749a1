#include "vulkan/device/features.h"

#include <algorithm>

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

struct Limit {
  const char* name;
  uint32_t told, least, most = UINT32_MAX;
};

/// Returns the limits that the kernels need beyond what Vulkan promises, groups of 128 with 16 KiB.
std::vector<Limit> limitsOf(const VkPhysicalDeviceLimits& basic,
                            const VkPhysicalDeviceVulkan13Properties& v13) {
  constexpr uint32_t kGroup = 256;            // Invocations of the largest groups.
  constexpr uint32_t kSubgroupMemory = 6144;  // Of the exact distance, whose groups need the most for each.
  constexpr uint32_t kSubgroups = 4;  // More if the smallest subgroup has less than a quarter of the largest.
  const uint32_t subgroups = std::max(kSubgroups, v13.maxSubgroupSize / std::max(v13.minSubgroupSize, 1U));
  return {{"maxComputeWorkGroupInvocations", basic.maxComputeWorkGroupInvocations, kGroup},
          {"maxComputeWorkGroupSize[0]", basic.maxComputeWorkGroupSize[0], kGroup},
          {"maxComputeSharedMemorySize", basic.maxComputeSharedMemorySize, subgroups * kSubgroupMemory},
          {"minSubgroupSize", v13.minSubgroupSize, 4},
          {"maxSubgroupSize", v13.maxSubgroupSize, 4, 128}};
}

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
  VkPhysicalDeviceVulkan13Properties v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
  VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES, &v13};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v11};
  vkGetPhysicalDeviceProperties2(device, &properties);
  for (const std::string& name :
       missingSubgroupOperations(v11.subgroupSupportedOperations, v11.subgroupSupportedStages))
    add(name);
  for (const Limit& limit : limitsOf(properties.properties.limits, v13)) {
    const bool isLess = limit.told < limit.least;
    if (isLess || limit.told > limit.most)
      add("a " + std::string(limit.name) + " of at " +
          (isLess ? "least " + std::to_string(limit.least) : "most " + std::to_string(limit.most)) +
          " (it is " + std::to_string(limit.told) + ")");
  }
  return missing;
}

}  // namespace raymap::vulkan
