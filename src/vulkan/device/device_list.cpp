#include "vulkan/device/device_list.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstdio>

#include "vulkan/device/features.h"
#include "vulkan/device/instance.h"

namespace raymap::vulkan {

namespace {

DeviceType typeOf(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return DeviceType::Discrete;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return DeviceType::Integrated;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return DeviceType::Virtual;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return DeviceType::Software;
    default:
      return DeviceType::Other;
  }
}

std::string versionText(uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version));
}

/// Adds what only devices with Vulkan 1.3 tell.
void describeSubgroups(VkPhysicalDevice device, DeviceInfo& info) {
  VkPhysicalDeviceVulkan13Properties v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
  VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES, &v13};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v11};
  vkGetPhysicalDeviceProperties2(device, &properties);
  info.subgroupSize = v11.subgroupSize;
  info.minSubgroupSize = v13.minSubgroupSize;
  info.maxSubgroupSize = v13.maxSubgroupSize;
  const VkPhysicalDeviceProperties& basic = properties.properties;
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, "%x.%x.%x.%x-%u-%u-", basic.vendorID, basic.deviceID,
                basic.driverVersion, basic.apiVersion, v13.minSubgroupSize, v13.maxSubgroupSize);
  info.fingerprint = numbers;
  for (const auto& uuid : {v11.deviceUUID, v11.driverUUID})
    for (size_t i = 0; i < VK_UUID_SIZE; ++i) {
      std::snprintf(numbers, sizeof numbers, "%02x", uuid[i]);
      info.fingerprint += numbers;
    }
}

std::string problemOf(VkPhysicalDevice device, uint32_t version) {
  if (version < VK_API_VERSION_1_3)
    return "it has Vulkan " + versionText(version) + ", 1.3 is needed; update its driver";
  if (!computeFamily(device)) return "it has no compute queue";
  const std::string missing = missingFeatures(device);
  return missing.empty() ? "" : "it lacks " + missing;
}

uint64_t largestHeap(VkPhysicalDevice device) {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(device, &memory);
  uint64_t largest = 0;
  for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if ((memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0)
      largest = std::max<uint64_t>(largest, memory.memoryHeaps[i].size);
  return largest;
}

}  // namespace

std::vector<VkPhysicalDevice> physicalDevices(VkInstance instance) {
  uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "listing devices");
  std::vector<VkPhysicalDevice> devices(count);
  check(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "listing devices");
  if (devices.empty())
    throw Error(
        ErrorCode::Unsupported,
        "no Vulkan driver finds a device; install the GPU's driver, or mesa-vulkan-drivers for one in "
        "software");
  return devices;
}

DeviceInfo describe(VkPhysicalDevice device) {
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  vkGetPhysicalDeviceProperties(device, &properties.properties);
  const VkPhysicalDeviceProperties& basic = properties.properties;
  const uint32_t version = basic.apiVersion;
  if (version >= VK_API_VERSION_1_2) {
    properties.pNext = &driver;
    vkGetPhysicalDeviceProperties2(device, &properties);
  }
  DeviceInfo info{
      .name = basic.deviceName,
      .type = typeOf(basic.deviceType),
      .driver = std::string(driver.driverName) + " " + driver.driverInfo,
      .memory = largestHeap(device),
      .sharedMemory = basic.limits.maxComputeSharedMemorySize,
      .problem = problemOf(device, version),
      .vulkanVersion = versionText(version) + "." + std::to_string(VK_API_VERSION_PATCH(version))};
  if (version >= VK_API_VERSION_1_3) describeSubgroups(device, info);
  return info;
}

std::optional<uint32_t> computeFamily(VkPhysicalDevice device) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  std::optional<uint32_t> found;
  for (uint32_t i = 0; i < count; ++i) {
    const VkQueueFlags flags = families[i].queueFlags;
    if ((flags & VK_QUEUE_COMPUTE_BIT) == 0) continue;
    if ((flags & VK_QUEUE_GRAPHICS_BIT) == 0) return i;
    if (!found) found = i;
  }
  return found;
}

std::vector<DeviceInfo> listDevices() {
  std::vector<DeviceInfo> devices;
  for (const VkPhysicalDevice device : physicalDevices(sharedInstance().handle())) {
    devices.push_back(describe(device));
    devices.back().id = "vulkan:" + std::to_string(devices.size() - 1);
  }
  return devices;
}

std::optional<size_t> bestDevice(const std::vector<DeviceInfo>& devices) {
  std::optional<size_t> best;
  for (size_t i = 0; i < devices.size(); ++i)
    if (devices[i].problem.empty() && (!best || devices[i].type < devices[*best].type)) best = i;
  return best;
}

}  // namespace raymap::vulkan
