#include "gpu.h"

#include <raymap/error.h>

using raymap::Error;
using raymap::ErrorCode;

void check(VkResult result, const char* what) {
  if (result == VK_SUCCESS) return;
  const ErrorCode code = result == VK_ERROR_DEVICE_LOST ? ErrorCode::DeviceLost
                         : result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY
                             ? ErrorCode::Memory
                             : ErrorCode::Unsupported;
  throw Error(code, std::string(what) + " failed: VkResult " + std::to_string(result));
}

Gpu::Gpu(std::optional<uint32_t> index) {
  makeInstance();
  choosePhysicalDevice(index);
  makeDevice();
  makeCommandBuffer();
}

Gpu::~Gpu() {
  vkDestroyQueryPool(handles_.device, stamps_, nullptr);
  vkDestroyFence(handles_.device, fence_, nullptr);
  vkDestroyCommandPool(handles_.device, pool_, nullptr);
  for (const Buffer& buffer : buffers_) destroy(buffer);
  vkDestroyDevice(handles_.device, nullptr);
  vkDestroyInstance(handles_.instance, nullptr);
}

void Gpu::makeInstance() {
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .pApplicationName = "raymap_animated",
                                      .apiVersion = VK_API_VERSION_1_3};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pApplicationInfo = &application};
  check(vkCreateInstance(&info, nullptr, &handles_.instance), "starting Vulkan 1.3");
}

void Gpu::choosePhysicalDevice(std::optional<uint32_t> index) {
  uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(handles_.instance, &count, nullptr), "listing devices");
  std::vector<VkPhysicalDevice> devices(count);
  check(vkEnumeratePhysicalDevices(handles_.instance, &count, devices.data()), "listing devices");
  if (count == 0) throw Error(ErrorCode::Unsupported, "Vulkan finds no device; install a driver");
  if (index && *index >= count)
    throw Error(ErrorCode::Usage,
                "there is no device " + std::to_string(*index) + ": Vulkan finds " + std::to_string(count));
  const auto properties = [](VkPhysicalDevice device) {
    VkPhysicalDeviceProperties result;
    vkGetPhysicalDeviceProperties(device, &result);
    return result;
  };
  handles_.physical = devices[index.value_or(0)];
  if (!index)
    for (const VkPhysicalDevice device : devices)
      if (properties(device).deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU) {
        handles_.physical = device;
        break;
      }
  name_ = properties(handles_.physical).deviceName;
  nanosecondsPerTick_ = properties(handles_.physical).limits.timestampPeriod;
}

void Gpu::makeDevice() {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(handles_.physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(handles_.physical, &count, families.data());
  uint32_t& family = handles_.queueFamily;
  while (family < count && (families[family].queueFlags & VK_QUEUE_COMPUTE_BIT) == 0) ++family;
  if (family == count) throw Error(ErrorCode::Unsupported, name_ + " cannot compute; use another device");
  if (families[family].timestampValidBits == 0) nanosecondsPerTick_ = 0.0;

  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                       .pNext = &v13};
  VkPhysicalDeviceFeatures2 v10{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};
  // All that raymap asks of a device that it is to share.
  raymap::vulkan::requireFeatures(v10.features, v12, v13);

  const float priority = 1.0F;
  const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = family,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority};
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = &v10,
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queue};
  check(vkCreateDevice(handles_.physical, &info, nullptr, &handles_.device), "starting the device");
  vkGetDeviceQueue(handles_.device, family, 0, &handles_.queue);
}

void Gpu::makeCommandBuffer() {
  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .queueFamilyIndex = handles_.queueFamily};
  check(vkCreateCommandPool(handles_.device, &pool, nullptr, &pool_), "making a command pool");
  const VkCommandBufferAllocateInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = pool_,
                                           .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                           .commandBufferCount = 1};
  check(vkAllocateCommandBuffers(handles_.device, &buffer, &commands_), "making a command buffer");
  const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check(vkCreateFence(handles_.device, &fence, nullptr, &fence_), "making a fence");
  const VkQueryPoolCreateInfo stamps{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                     .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                     .queryCount = kMaxStamps};
  check(vkCreateQueryPool(handles_.device, &stamps, nullptr, &stamps_), "making timestamps");
}

uint32_t Gpu::memoryType(uint32_t allowed, VkMemoryPropertyFlags flags) const {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(handles_.physical, &memory);
  for (uint32_t type = 0; type < memory.memoryTypeCount; ++type)
    if ((allowed >> type & 1U) != 0 && (memory.memoryTypes[type].propertyFlags & flags) == flags) return type;
  throw Error(ErrorCode::Unsupported, name_ + " has no memory that suits; use another device");
}

Buffer Gpu::makeBuffer(VkDeviceSize bytes, bool isForHost) {
  Buffer& buffer = buffers_.emplace_back();  // At once, so that it is destroyed whatever fails.
  buffer.bytes = bytes;
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .size = bytes,
                                // raymap reaches buffers by their addresses.
                                .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                         VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                                         VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  check(vkCreateBuffer(handles_.device, &info, nullptr, &buffer.handle), "making a buffer");
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(handles_.device, buffer.handle, &needs);
  const VkMemoryPropertyFlags flags =
      isForHost ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT
                : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
  const VkMemoryAllocateFlagsInfo address{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                          .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
  const VkMemoryAllocateInfo memory{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                    .pNext = &address,
                                    .allocationSize = needs.size,
                                    .memoryTypeIndex = memoryType(needs.memoryTypeBits, flags)};
  check(vkAllocateMemory(handles_.device, &memory, nullptr, &buffer.memory), "allocating a buffer");
  check(vkBindBufferMemory(handles_.device, buffer.handle, buffer.memory, 0), "binding a buffer");
  if (isForHost)
    check(vkMapMemory(handles_.device, buffer.memory, 0, VK_WHOLE_SIZE, 0, &buffer.mapped),
          "mapping a buffer");
  return buffer;
}

void Gpu::destroy(const Buffer& buffer) {
  vkDestroyBuffer(handles_.device, buffer.handle, nullptr);
  vkFreeMemory(handles_.device, buffer.memory, nullptr);
}

Buffer Gpu::upload(std::span<const std::byte> bytes) {
  const Buffer buffer = makeBuffer(bytes.size()), staging = makeBuffer(bytes.size(), true);
  std::memcpy(staging.mapped, bytes.data(), bytes.size());
  const VkBufferCopy all{.size = bytes.size()};
  vkCmdCopyBuffer(begin(), staging.handle, buffer.handle, 1, &all);
  submitAndWait();
  destroy(staging);
  buffers_.pop_back();
  return buffer;
}

VkCommandBuffer Gpu::begin() {
  check(vkResetCommandPool(handles_.device, pool_, 0), "resetting a command pool");
  const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  check(vkBeginCommandBuffer(commands_, &info), "recording");
  vkCmdResetQueryPool(commands_, stamps_, 0, kMaxStamps);
  stampCount_ = 0;
  return commands_;
}

void Gpu::stamp() {
  if (nanosecondsPerTick_ > 0.0)
    vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, stamps_, stampCount_++);
}

void Gpu::submitAndWait() {
  check(vkEndCommandBuffer(commands_), "recording");
  const VkSubmitInfo submit{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands_};
  check(vkResetFences(handles_.device, 1, &fence_), "resetting a fence");
  check(vkQueueSubmit(handles_.queue, 1, &submit, fence_), "submitting");
  check(vkWaitForFences(handles_.device, 1, &fence_, VK_TRUE, UINT64_MAX), "waiting for the device");
}

std::vector<double> Gpu::times() const {
  if (stampCount_ < 2) return {};
  std::vector<uint64_t> ticks(stampCount_);
  check(vkGetQueryPoolResults(handles_.device, stamps_, 0, stampCount_, ticks.size() * sizeof(uint64_t),
                              ticks.data(), sizeof(uint64_t),
                              VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "reading timestamps");
  std::vector<double> milliseconds;
  for (size_t i = 1; i < ticks.size(); ++i)
    milliseconds.push_back(1e-6 * nanosecondsPerTick_ * double(ticks[i] - ticks[i - 1]));
  return milliseconds;
}
