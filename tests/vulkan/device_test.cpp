#include "vulkan/device/device.h"

#include <algorithm>
#include <string>
#include <vector>

#include "counters/vulkan_entry.h"
#include "error_code.h"
#include "shaders/number_invocations.h"
#include "shaders/number_invocations_spv.h"
#include "told_limits.h"
#include "vulkan/device/features.h"
#include "vulkan/device/instance.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

TEST(VulkanErrors, KeepTheirCodes) {
  EXPECT_EQ(codeOf([] { check(VK_ERROR_DEVICE_LOST, "waiting"); }), ErrorCode::DeviceLost);
  EXPECT_EQ(codeOf([] { check(VK_ERROR_OUT_OF_DEVICE_MEMORY, "allocating"); }), ErrorCode::DeviceMemory);
  EXPECT_EQ(codeOf([] { check(VK_ERROR_OUT_OF_HOST_MEMORY, "allocating"); }), ErrorCode::Memory);
  EXPECT_EQ(codeOf([] { check(VK_ERROR_FEATURE_NOT_PRESENT, "starting"); }), ErrorCode::Unsupported);
}

TEST(VulkanDevices, PreferHardwareOverSoftware) {
  using enum DeviceType;
  const auto best = [](const std::vector<DeviceType>& types, size_t broken = SIZE_MAX) {
    std::vector<DeviceInfo> devices;
    for (const DeviceType type : types) devices.push_back({.type = type});
    if (broken < devices.size()) devices[broken].problem = "broken";
    return bestDevice(devices);
  };
  EXPECT_EQ(best({Software, Integrated, Discrete, Discrete}), 2u);
  EXPECT_EQ(best({Software, Integrated, Discrete}, 2), 1u);
  EXPECT_EQ(best({Software}), 0u);
  EXPECT_EQ(best({Software}, 0), std::nullopt);
  EXPECT_EQ(best({}), std::nullopt);
}

class VulkanDevice : public VulkanTest {};

TEST_F(VulkanDevice, DescribesItself) {
  EXPECT_FALSE(device().info().name.empty());
  EXPECT_EQ(device().info().problem, "");
  EXPECT_GE(device().limits().sharedMemory, 16384u);
  EXPECT_GT(device().limits().bufferSize, 1u << 30);
  EXPECT_GE(device().limits().maxSubgroupSize, device().limits().minSubgroupSize);
  const std::vector<DeviceInfo> all = listDevices();
  EXPECT_TRUE(std::any_of(all.begin(), all.end(),
                          [](const DeviceInfo& info) { return info.name == device().info().name; }));
}

TEST_F(VulkanDevice, RefusesAnUnknownNumber) {
  EXPECT_EQ(codeOf([] { const Device none({.index = 1000}); }), ErrorCode::Unsupported);
}

TEST_F(VulkanDevice, NamesTheLimitsThatADeviceLacks) {
  const auto problemOf = [](ToldLimits::Change change) {
    const ToldLimits told(std::move(change));
    return describe(physicalDevices(sharedInstance().handle()).front()).problem;
  };
  const auto withSubgroups = [&](uint32_t least, uint32_t most) {
    return problemOf([=](VkPhysicalDeviceProperties2& told) {
      if (auto* v13 = ToldLimits::find<VkPhysicalDeviceVulkan13Properties>(
              told, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES))
        v13->minSubgroupSize = least, v13->maxSubgroupSize = most;
      told.properties.limits.maxComputeSharedMemorySize = 24576;
    });
  };
  EXPECT_EQ(problemOf([](auto& told) {
              told.properties.limits.maxComputeWorkGroupInvocations = 128;
              told.properties.limits.maxComputeWorkGroupSize[0] = 255;
            }),
            "it lacks a maxComputeWorkGroupInvocations of at least 256 (it is 128), a "
            "maxComputeWorkGroupSize[0] of at least 256 (it is 255)");
  EXPECT_EQ(problemOf([](auto& told) { told.properties.limits.maxComputeSharedMemorySize = 24575; }),
            "it lacks a maxComputeSharedMemorySize of at least 24576 (it is 24575)");
  EXPECT_EQ(withSubgroups(4, 16), "");
  EXPECT_EQ(withSubgroups(128, 128), "");
  EXPECT_EQ(withSubgroups(8, 64), "it lacks a maxComputeSharedMemorySize of at least 49152 (it is 24576)");
  EXPECT_EQ(withSubgroups(2, 4), "it lacks a minSubgroupSize of at least 4 (it is 2)");
  EXPECT_EQ(withSubgroups(64, 256), "it lacks a maxSubgroupSize of at most 128 (it is 256)");
}

PFN_vkEnumerateDeviceExtensionProperties realExtensions = nullptr;
PFN_vkCreateDevice realCreateDevice = nullptr;
std::vector<std::string> enabledExtensions;

/// Lists VK_KHR_portability_subset besides the driver's extensions.
VKAPI_ATTR VkResult VKAPI_CALL listPortability(VkPhysicalDevice device, const char* layer, uint32_t* count,
                                               VkExtensionProperties* properties) {
  if (!properties) {
    const VkResult result = realExtensions(device, layer, count, nullptr);
    ++*count;
    return result;
  }
  uint32_t others = *count - 1;
  const VkResult result = realExtensions(device, layer, &others, properties);
  properties[others] = {"VK_KHR_portability_subset", 1};
  *count = others + 1;
  return result;
}

/// Makes a device without the extensions that the caller enables, and notes them.
VKAPI_ATTR VkResult VKAPI_CALL noteExtensions(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                              const VkAllocationCallbacks* allocator, VkDevice* device) {
  enabledExtensions.assign(info->ppEnabledExtensionNames,
                           info->ppEnabledExtensionNames + info->enabledExtensionCount);
  VkDeviceCreateInfo plain = *info;
  plain.enabledExtensionCount = 0;
  return realCreateDevice(physical, &plain, allocator, device);
}

TEST_F(VulkanDevice, EnablesThePortabilitySubsetOfADeviceThatHasIt) {
  const ReplacedEntry created(vkCreateDevice, noteExtensions);
  realCreateDevice = created.real();
  const Device conformant({.validation = Validation::Off});
  EXPECT_EQ(enabledExtensions, std::vector<std::string>{});
  const ReplacedEntry listed(vkEnumerateDeviceExtensionProperties, listPortability);
  realExtensions = listed.real();
  const Device portable({.validation = Validation::Off});
  EXPECT_EQ(enabledExtensions, std::vector<std::string>{"VK_KHR_portability_subset"});
}

/// A device made as a caller would make it.
struct Foreign {
  Foreign() {
    borrowed.instance = instance.handle();
    borrowed.physical = physicalDevices(instance.handle()).front();
    borrowed.queueFamily = computeFamily(borrowed.physical).value();
    const float priority = 1.0F;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = borrowed.queueFamily,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    Features features;
    setRequired(features);
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &features.v10,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue};
    check(vkCreateDevice(borrowed.physical, &info, nullptr, &borrowed.device), "making a device");
    vkGetDeviceQueue(borrowed.device, borrowed.queueFamily, 0, &borrowed.queue);
  }
  ~Foreign() { vkDestroyDevice(borrowed.device, nullptr); }
  Foreign(const Foreign&) = delete;
  Foreign& operator=(const Foreign&) = delete;

  std::string messages;
  Instance instance{isValidated() ? Validation::On : Validation::Off,
                    [this](std::string_view message) { messages += message; }};
  DeviceHandles borrowed;
};

TEST_F(VulkanDevice, WorksOnACallersDevice) {
  Foreign foreign;
  {
    Device device(foreign.borrowed);
    DeviceBuffer buffer(device, "groups", MemoryUse::ReadBack);
    buffer.resize<uint32_t>(100);
    Kernel<NumberInvocationsPush> kernel(device, shaders::kNumberInvocations, 10);
    CommandBuffer own(device);
    Commands commands = own.begin();
    commands.dispatch(kernel, {.groups = buffer.address(), .count = 100, .groupSize = 10}, 100);
    own.submitAndWait();
    EXPECT_EQ(buffer.mapped<uint32_t>()[99], 9u);
  }
  EXPECT_EQ(foreign.messages, "");
}

}  // namespace
}  // namespace raymap::vulkan
