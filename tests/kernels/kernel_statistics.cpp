#include "kernel_statistics.h"

#include <algorithm>
#include <cstring>
#include <mutex>
#include <tuple>

#include "counters/shader_names.h"
#include "counters/vulkan_entry.h"
#include "vulkan/device/instance.h"

namespace raymap::vulkan {

namespace {

/// Shaders by module, and all kernels made so far.
struct State {
  std::mutex mutex;
  std::map<VkShaderModule, std::string> modules;
  std::vector<CompiledKernel> kernels;
  uint32_t subgroupSize = 0;
};

State& state() {
  static State state;
  return state;
}

std::vector<uint32_t> constantsOf(const VkSpecializationInfo& info) {
  std::vector<uint32_t> constants(info.dataSize / sizeof(uint32_t));
  std::memcpy(constants.data(), info.pData, info.dataSize);
  return constants;
}

double valueOf(const VkPipelineExecutableStatisticKHR& statistic) {
  switch (statistic.format) {
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR:
      return statistic.value.b32;
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR:
      return double(statistic.value.i64);
    case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR:
      return double(statistic.value.u64);
    default:
      return statistic.value.f64;
  }
}

uint32_t subgroupSizeOf(VkDevice device, VkPipeline pipeline) {
  const VkPipelineInfoKHR info{.sType = VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, .pipeline = pipeline};
  VkPipelineExecutablePropertiesKHR properties{.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR};
  uint32_t count = 1;
  check(vkGetPipelineExecutablePropertiesKHR(device, &info, &count, &properties), "reading a kernel's size");
  return properties.subgroupSize;
}

std::map<std::string, double> statisticsOf(VkDevice device, VkPipeline pipeline) {
  const VkPipelineExecutableInfoKHR info{.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR,
                                         .pipeline = pipeline};
  uint32_t count = 0;
  check(vkGetPipelineExecutableStatisticsKHR(device, &info, &count, nullptr), "reading statistics");
  std::vector<VkPipelineExecutableStatisticKHR> found(
      count, {.sType = VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR});
  check(vkGetPipelineExecutableStatisticsKHR(device, &info, &count, found.data()), "reading statistics");
  std::map<std::string, double> statistics;
  for (const VkPipelineExecutableStatisticKHR& statistic : found)
    statistics[statistic.name] = valueOf(statistic);
  return statistics;
}

}  // namespace

struct KernelStatistics::Entries {
  static VKAPI_ATTR VkResult VKAPI_CALL makeDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                                   const VkAllocationCallbacks* allocator, VkDevice* device);
  static VKAPI_ATTR VkResult VKAPI_CALL makeModule(VkDevice device, const VkShaderModuleCreateInfo* info,
                                                   const VkAllocationCallbacks* allocator,
                                                   VkShaderModule* module);
  static VKAPI_ATTR VkResult VKAPI_CALL makePipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                                      const VkComputePipelineCreateInfo* infos,
                                                      const VkAllocationCallbacks* allocator,
                                                      VkPipeline* pipelines);

  ReplacedEntry<PFN_vkCreateDevice> createDevice{vkCreateDevice, makeDevice};
  ReplacedEntry<PFN_vkCreateShaderModule> createModule{vkCreateShaderModule, makeModule};
  ReplacedEntry<PFN_vkCreateComputePipelines> createPipelines{vkCreateComputePipelines, makePipelines};
  static inline Entries* current = nullptr;
};

VkResult KernelStatistics::Entries::makeDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                               const VkAllocationCallbacks* allocator, VkDevice* device) {
  VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR feature{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR,
      .pNext = const_cast<void*>(info->pNext),
      .pipelineExecutableInfo = VK_TRUE};
  std::vector<const char*> extensions(info->ppEnabledExtensionNames,
                                      info->ppEnabledExtensionNames + info->enabledExtensionCount);
  extensions.push_back(VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME);
  VkDeviceCreateInfo extended = *info;
  extended.pNext = &feature;
  extended.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  extended.ppEnabledExtensionNames = extensions.data();
  return current->createDevice.real()(physical, &extended, allocator, device);
}

VkResult KernelStatistics::Entries::makeModule(VkDevice device, const VkShaderModuleCreateInfo* info,
                                               const VkAllocationCallbacks* allocator,
                                               VkShaderModule* module) {
  const VkResult result = current->createModule.real()(device, info, allocator, module);
  const std::lock_guard lock(state().mutex);
  if (result == VK_SUCCESS) state().modules[*module] = shaderName(*info);
  return result;
}

VkResult KernelStatistics::Entries::makePipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                                  const VkComputePipelineCreateInfo* infos,
                                                  const VkAllocationCallbacks* allocator,
                                                  VkPipeline* pipelines) {
  std::vector<VkComputePipelineCreateInfo> captured(infos, infos + count);
  VkPipelineShaderStageRequiredSubgroupSizeCreateInfo size{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_REQUIRED_SUBGROUP_SIZE_CREATE_INFO,
      .requiredSubgroupSize = state().subgroupSize};
  for (VkComputePipelineCreateInfo& info : captured) {
    info.flags |= VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
    if (size.requiredSubgroupSize != 0) info.stage.pNext = &size;
  }
  const VkResult result =
      current->createPipelines.real()(device, cache, count, captured.data(), allocator, pipelines);
  if (result != VK_SUCCESS) return result;
  const std::lock_guard lock(state().mutex);
  for (uint32_t i = 0; i < count; ++i) {
    const VkPipelineShaderStageCreateInfo& stage = infos[i].stage;
    state().kernels.push_back(
        {.name = state().modules.at(stage.module),
         .constants = constantsOf(*stage.pSpecializationInfo),
         .subgroupSize = subgroupSizeOf(device, pipelines[i]),
         .hasFullSubgroups = (stage.flags & VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT) != 0,
         .statistics = statisticsOf(device, pipelines[i])});
  }
  return result;
}

KernelStatistics::KernelStatistics(uint32_t subgroupSize) {
  state().subgroupSize = subgroupSize;
  sharedInstance();  // Loads the functions.
  Entries::current = entries_ = new Entries();
}

KernelStatistics::~KernelStatistics() {
  delete entries_;
  Entries::current = nullptr;
}

std::vector<CompiledKernel> KernelStatistics::kernels() const {
  const std::lock_guard lock(state().mutex);
  std::vector<CompiledKernel> kernels = state().kernels;
  const auto key = [](const CompiledKernel& kernel) { return std::tie(kernel.name, kernel.constants); };
  std::ranges::stable_sort(kernels, {}, key);
  const auto repeated = std::ranges::unique(kernels, {}, key);
  kernels.erase(repeated.begin(), repeated.end());
  return kernels;
}

}  // namespace raymap::vulkan
