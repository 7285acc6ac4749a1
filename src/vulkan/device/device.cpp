#include "vulkan/device/device.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "base/memory.h"

namespace raymap::vulkan {

namespace {

/// Kernels read indices as signed, and elements have at least four bytes (kernel.glsl).
constexpr uint64_t kMostBytes = (uint64_t{1} << 31) * sizeof(uint32_t);
/// Must be enabled on a device that lists it. Its header is a draft, which volk.h leaves out.
constexpr const char* kPortabilitySubset = "VK_KHR_portability_subset";

size_t choose(const std::vector<DeviceInfo>& devices, std::optional<size_t> index) {
  const std::optional<size_t> chosen = index ? index : bestDevice(devices);
  if (!chosen)
    throw Error(
        ErrorCode::Unsupported,
        "no Vulkan device is usable" +
            (devices.empty() ? "; install a driver" : ": " + devices[0].name + ": " + devices[0].problem));
  const std::string name = "vulkan:" + std::to_string(*chosen);
  if (*chosen >= devices.size())
    throw Error(ErrorCode::Unsupported, "there is no device " + name + ": the number of Vulkan devices is " +
                                            std::to_string(devices.size()));
  if (!devices[*chosen].problem.empty())
    throw Error(ErrorCode::Unsupported,
                name + " (" + devices[*chosen].name + ") cannot be used: " + devices[*chosen].problem);
  return *chosen;
}

bool hasExtension(VkPhysicalDevice device, const char* name) {
  uint32_t count = 0;
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "listing extensions");
  std::vector<VkExtensionProperties> found(count);
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, found.data()), "listing extensions");
  return std::any_of(found.begin(), found.end(), [name](const VkExtensionProperties& extension) {
    return std::strcmp(extension.extensionName, name) == 0;
  });
}

DriverIdentity identityOf(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  vkGetPhysicalDeviceProperties2(device, &properties);
  const VkPhysicalDeviceProperties& basic = properties.properties;
  return {.vendor = basic.vendorID,
          .device = basic.deviceID,
          .driverVersion = basic.driverVersion,
          .cacheId = std::to_array(basic.pipelineCacheUUID)};
}

}  // namespace

Device::Device(const DeviceOptions& options) {
  if (options.validation != Validation::Off)
    ownInstance_ = std::make_unique<Instance>(options.validation, options.message);
  handles_.instance = (ownInstance_ ? *ownInstance_ : sharedInstance()).handle();
  const std::vector<VkPhysicalDevice> found = physicalDevices(handles_.instance);
  std::vector<DeviceInfo> infos;
  for (const VkPhysicalDevice device : found) infos.push_back(describe(device));
  const size_t chosen = choose(infos, options.index);
  handles_.physical = found[chosen];
  info_ = infos[chosen];
  if (options.guards) guards_ = std::make_unique<Guards>();
  if (options.validation != Validation::Off)
    setName_ = extensionFunction<PFN_vkSetDebugUtilsObjectNameEXT>(handles_.instance,
                                                                   "vkSetDebugUtilsObjectNameEXT");
  makeDevice();
  readLimits();
  makeShared();
}

Device::Device(const DeviceHandles& borrowed)
    : handles_(borrowed), device_(borrowed.device, Destroy{false}), isBorrowed_(true) {
  openLoader();
  loadFunctions(borrowed.instance);
  info_ = describe(handles_.physical);
  if (!info_.problem.empty())
    throw Error(ErrorCode::Unsupported, info_.name + " cannot be used: " + info_.problem);
  readLimits();
  makeShared();
}

Device::~Device() = default;

void Device::makeDevice() {
  handles_.queueFamily = computeFamily(handles_.physical).value();
  const float priority = 1.0F;
  const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = queueFamily(),
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority};
  Features features;
  setRequired(features);
  const VkDeviceCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
      .pNext = &features.v10,
      .queueCreateInfoCount = 1,
      .pQueueCreateInfos = &queue,
      .enabledExtensionCount = hasExtension(handles_.physical, kPortabilitySubset) ? 1U : 0U,
      .ppEnabledExtensionNames = &kPortabilitySubset};
  check(vkCreateDevice(handles_.physical, &info, nullptr, &handles_.device), "starting " + info_.name);
  device_.reset(handles_.device);
  vkGetDeviceQueue(handles_.device, queueFamily(), 0, &handles_.queue);
}

void Device::readLimits() {
  VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceVulkan13Properties v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES, &v11};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v13};
  vkGetPhysicalDeviceProperties2(handles_.physical, &properties);
  const VkPhysicalDeviceLimits& basic = properties.properties.limits;
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(handles_.physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(handles_.physical, &count, families.data());
  const uint32_t timestampBits = families.at(queueFamily()).timestampValidBits;
  limits_ = {.groupSize = std::min(basic.maxComputeWorkGroupInvocations, basic.maxComputeWorkGroupSize[0]),
             .sharedMemory = basic.maxComputeSharedMemorySize,
             .minSubgroupSize = v13.minSubgroupSize,
             .maxSubgroupSize = v13.maxSubgroupSize,
             .bufferSize = std::min({v13.maxBufferSize, v11.maxMemoryAllocationSize, kMostBytes}),
             .timestampPeriod = timestampBits > 0 ? basic.timestampPeriod : 0.0,
             .timestampBits = timestampBits,
             .hasMemoryBudget = hasExtension(handles_.physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME)};
  vkGetPhysicalDeviceMemoryProperties(handles_.physical, &memory_);
}

void Device::makeShared() {
  const VkPushConstantRange range{.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .offset = 0, .size = kPushBytes};
  const VkPipelineLayoutCreateInfo layout{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                          .pushConstantRangeCount = 1,
                                          .pPushConstantRanges = &range};
  create(pipelineLayout_, handle(), vkCreatePipelineLayout, layout, "making the layout of all kernels");
  // A caller's device is the caller's business.
  std::optional<PipelineCacheFile> file;
  if (!isBorrowed_) file.emplace(identityOf(handles_.physical));
  pipelines_.emplace(*this, file);
}

uint32_t Device::memoryType(MemoryUse use, uint32_t allowed) const {
  constexpr VkMemoryPropertyFlags kOwn = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
  constexpr VkMemoryPropertyFlags kMapped =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  constexpr VkMemoryPropertyFlags kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  std::array<VkMemoryPropertyFlags, 4> wishes{};  // In order of preference.
  wishes.fill(kMapped);
  if (use == MemoryUse::ReadBack) wishes[0] |= kCached;
  if (use == MemoryUse::Device) wishes.fill(kOwn);
  // The host reads the guards after every run. A card's own memory would take it a microsecond a byte. Images
  // have no guards, and may lie in no other memory.
  if (use == MemoryUse::Device && guards_)
    wishes = {kOwn | kMapped | kCached, kMapped | kCached, kMapped, kOwn};
  for (const VkMemoryPropertyFlags wish : wishes)
    for (uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
      if ((allowed >> i & 1U) != 0 && (memory_.memoryTypes[i].propertyFlags & wish) == wish) return i;
  throw Error(ErrorCode::Unsupported, info_.name + " has no suitable memory type; use another device");
}

bool Device::isShared(uint32_t memoryType) const {
  constexpr VkMemoryPropertyFlags kShared =
      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
      VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  return (memory_.memoryTypes[memoryType].propertyFlags & kShared) == kShared;
}

uint64_t Device::availableMemory(uint32_t memoryType) const {
  const uint32_t heap = memory_.memoryTypes[memoryType].heapIndex;
  uint64_t available = memory_.memoryHeaps[heap].size;
  if (limits_.hasMemoryBudget) {
    VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT};
    VkPhysicalDeviceMemoryProperties2 memory{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2, &budget};
    vkGetPhysicalDeviceMemoryProperties2(handles_.physical, &memory);
    available = budget.heapBudget[heap] - std::min(budget.heapBudget[heap], budget.heapUsage[heap]);
  } else {
    available -= std::min(available, heldMemory_);
  }
  const bool isHosts = info_.type == DeviceType::Software || info_.type == DeviceType::Integrated;
  return isHosts ? std::min<uint64_t>(available, raymap::memoryLeft()) : available;
}

void Device::setName(VkObjectType type, uint64_t handle, const std::string& name) const {
  if (!setName_) return;
  const VkDebugUtilsObjectNameInfoEXT info{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                           .objectType = type,
                                           .objectHandle = handle,
                                           .pObjectName = name.c_str()};
  setName_(this->handle(), &info);
}

}  // namespace raymap::vulkan
