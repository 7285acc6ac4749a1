#include "gpu.h"

#include <raymap/error.h>

#include <algorithm>
#include <charconv>
#include <cstring>

namespace raymap::view {

namespace {

/// Returns K of "vulkan:K".
std::optional<uint32_t> numberIn(const std::string& device) {
  constexpr std::string_view kPrefix = "vulkan:";
  if (!device.starts_with(kPrefix)) return {};
  uint32_t number = 0;
  const char* end = device.data() + device.size();
  if (std::from_chars(device.data() + kPrefix.size(), end, number).ptr != end)
    throw Error(ErrorCode::Usage, "there is no device '" + device + "'; see raymap devices");
  return number;
}

/// Returns a family of queues that draws, computes and presents.
std::optional<uint32_t> familyOf(VkPhysicalDevice device, VkSurfaceKHR surface) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (uint32_t family = 0; family < count; ++family) {
    VkBool32 presents = VK_FALSE;
    vkGetPhysicalDeviceSurfaceSupportKHR(device, family, surface, &presents);
    if ((families[family].queueFlags & kNeeded) == kNeeded && presents) return family;
  }
  return {};
}

VkPhysicalDeviceProperties propertiesOf(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties result;
  vkGetPhysicalDeviceProperties(device, &result);
  return result;
}

bool hasExtension(VkPhysicalDevice device, std::string_view name) {
  uint32_t count = 0;
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "listing extensions");
  std::vector<VkExtensionProperties> all(count);
  check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data()), "listing extensions");
  return std::ranges::any_of(all, [&](const auto& each) { return name == each.extensionName; });
}

}  // namespace

void check(VkResult result, const char* what) {
  if (result == VK_SUCCESS) return;
  const bool isMemory = result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY;
  const ErrorCode code = result == VK_ERROR_DEVICE_LOST ? ErrorCode::DeviceLost
                         : isMemory                     ? ErrorCode::DeviceMemory
                                                        : ErrorCode::Unsupported;
  throw Error(code, std::string(what) + " failed: VkResult " + std::to_string(result));
}

Gpu::Gpu(const std::string& device, std::span<const char* const> extensions, const MakeSurface& makeSurface) {
  makeInstance(extensions);
  surface_ = makeSurface(handles_.instance);
  choosePhysicalDevice(device);
  makeDevice();
}

Gpu::~Gpu() {
  vkDestroyDevice(handles_.device, nullptr);
  vkDestroySurfaceKHR(handles_.instance, surface_, nullptr);
  vkDestroyInstance(handles_.instance, nullptr);
}

void Gpu::makeInstance(std::span<const char* const> extensions) {
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .pApplicationName = "raymap view",
                                      .apiVersion = VK_API_VERSION_1_3};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pApplicationInfo = &application,
                                  .enabledExtensionCount = uint32_t(extensions.size()),
                                  .ppEnabledExtensionNames = extensions.data()};
  check(vkCreateInstance(&info, nullptr, &handles_.instance), "starting Vulkan 1.3");
}

void Gpu::choosePhysicalDevice(const std::string& device) {
  uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(handles_.instance, &count, nullptr), "listing devices");
  std::vector<VkPhysicalDevice> devices(count);
  check(vkEnumeratePhysicalDevices(handles_.instance, &count, devices.data()), "listing devices");
  const std::optional<uint32_t> number = numberIn(device);
  if (number && *number >= count)
    throw Error(ErrorCode::Usage, "there is no device " + device + "; see raymap devices");
  if (number) devices = {devices[*number]};
  std::optional<uint32_t> family;
  for (const bool isSoftware : {false, true})
    for (const VkPhysicalDevice each : devices) {
      if (family || (propertiesOf(each).deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU) != isSoftware) continue;
      family = familyOf(each, surface_);
      handles_.physical = each;
      isSoftware_ = isSoftware;
    }
  if (!family)
    throw Error(ErrorCode::Unsupported,
                "no Vulkan device can show a window; install a GPU's driver, or "
                "mesa-vulkan-drivers for one in software");
  handles_.queueFamily = *family;
  const VkPhysicalDeviceProperties properties = propertiesOf(handles_.physical);
  name_ = properties.deviceName;
  if (properties.limits.timestampComputeAndGraphics) nanosecondsPerTick_ = properties.limits.timestampPeriod;
}

void Gpu::makeDevice() {
  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                       .pNext = &v13};
  VkPhysicalDeviceFeatures2 v10{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};
  vulkan::requireFeatures(v10.features, v12, v13);
  v13.dynamicRendering = VK_TRUE;
  const float priority = 1.0F;
  const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = handles_.queueFamily,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority};
  knowsMemory_ = hasExtension(handles_.physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
  const char* const extensions[] = {VK_KHR_SWAPCHAIN_EXTENSION_NAME, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME};
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = &v10,
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queue,
                                .enabledExtensionCount = knowsMemory_ ? 2U : 1U,
                                .ppEnabledExtensionNames = extensions};
  check(vkCreateDevice(handles_.physical, &info, nullptr, &handles_.device), "starting the device");
  vkGetDeviceQueue(handles_.device, handles_.queueFamily, 0, &handles_.queue);
}

std::optional<Gpu::Memory> Gpu::memory() const {
  if (!knowsMemory_) return {};
  VkPhysicalDeviceMemoryBudgetPropertiesEXT budget{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT};
  VkPhysicalDeviceMemoryProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_PROPERTIES_2,
                                               .pNext = &budget};
  vkGetPhysicalDeviceMemoryProperties2(handles_.physical, &properties);
  Memory memory;
  for (uint32_t heap = 0; heap < properties.memoryProperties.memoryHeapCount; ++heap) {
    if ((properties.memoryProperties.memoryHeaps[heap].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) == 0)
      continue;
    memory.held += budget.heapUsage[heap];
    memory.most += budget.heapBudget[heap];
  }
  return memory;
}

uint32_t Gpu::memoryType(uint32_t allowed, VkMemoryPropertyFlags flags) const {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(handles_.physical, &memory);
  for (uint32_t type = 0; type < memory.memoryTypeCount; ++type)
    if ((allowed >> type & 1U) != 0 && (memory.memoryTypes[type].propertyFlags & flags) == flags) return type;
  throw Error(ErrorCode::Unsupported, name_ + " has no memory that suits; use another device");
}

Owned<VkDeviceMemory> Gpu::allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags,
                                    bool hasAddress) const {
  const VkMemoryAllocateFlagsInfo address{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                          .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
  const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .pNext = hasAddress ? &address : nullptr,
                                  .allocationSize = needs.size,
                                  .memoryTypeIndex = memoryType(needs.memoryTypeBits, flags)};
  VkDeviceMemory memory = VK_NULL_HANDLE;
  check(vkAllocateMemory(device(), &info, nullptr, &memory), "allocating memory on the device");
  return own(device(), memory, vkFreeMemory);
}

Buffer Gpu::makeBuffer(VkDeviceSize bytes, bool isForHost) const {
  Buffer buffer;
  buffer.bytes = bytes;
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .size = bytes,
                                .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                         VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                                         VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  VkBuffer handle = VK_NULL_HANDLE;
  check(vkCreateBuffer(device(), &info, nullptr, &handle), "making a buffer");
  buffer.handle = own(device(), handle, vkDestroyBuffer);
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device(), handle, &needs);
  buffer.memory =
      allocate(needs,
               isForHost ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT
                         : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
               true);
  check(vkBindBufferMemory(device(), handle, buffer.memory.get(), 0), "binding a buffer");
  if (isForHost)
    check(vkMapMemory(device(), buffer.memory.get(), 0, VK_WHOLE_SIZE, 0, &buffer.mapped),
          "mapping a buffer");
  const VkBufferDeviceAddressInfo address{.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
                                          .buffer = handle};
  buffer.address = vkGetBufferDeviceAddress(device(), &address);
  return buffer;
}

Buffer Gpu::stage(std::span<const std::byte> bytes) const {
  Buffer buffer = makeBuffer(bytes.size(), true);
  std::memcpy(buffer.mapped, bytes.data(), bytes.size());
  return buffer;
}

Image Gpu::makeImage(VkExtent2D size, VkFormat format, VkImageUsageFlags usage,
                     VkImageAspectFlags aspect) const {
  Image image;
  image.size = size;
  const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                               .imageType = VK_IMAGE_TYPE_2D,
                               .format = format,
                               .extent = {size.width, size.height, 1},
                               .mipLevels = 1,
                               .arrayLayers = 1,
                               .samples = VK_SAMPLE_COUNT_1_BIT,
                               .tiling = VK_IMAGE_TILING_OPTIMAL,
                               .usage = usage};
  VkImage handle = VK_NULL_HANDLE;
  check(vkCreateImage(device(), &info, nullptr, &handle), "making an image");
  image.handle = own(device(), handle, vkDestroyImage);
  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(device(), handle, &needs);
  image.memory = allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, false);
  check(vkBindImageMemory(device(), handle, image.memory.get(), 0), "binding an image");
  const VkImageViewCreateInfo viewInfo{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                       .image = handle,
                                       .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                       .format = format,
                                       .subresourceRange = {aspect, 0, 1, 0, 1}};
  VkImageView view = VK_NULL_HANDLE;
  check(vkCreateImageView(device(), &viewInfo, nullptr, &view), "making a view of an image");
  image.view = own(device(), view, vkDestroyImageView);
  return image;
}

Owned<VkShaderModule> Gpu::makeShader(std::span<const uint32_t> code) const {
  const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                      .codeSize = code.size_bytes(),
                                      .pCode = code.data()};
  VkShaderModule shader = VK_NULL_HANDLE;
  check(vkCreateShaderModule(device(), &info, nullptr, &shader), "making a shader");
  return own(device(), shader, vkDestroyShaderModule);
}

void barrier(VkCommandBuffer commands) {
  const VkMemoryBarrier2 all{
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
      .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
      .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
      .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
      .dstAccessMask =
          VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_HOST_READ_BIT};
  const VkDependencyInfo info{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &all};
  vkCmdPipelineBarrier2(commands, &info);
}

void moveImage(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
               VkImageAspectFlags aspect) {
  const VkImageMemoryBarrier2 move{
      .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
      .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
      .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
      .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
      .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
      .oldLayout = from,
      .newLayout = to,
      .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .image = image,
      .subresourceRange = {aspect, 0, 1, 0, 1}};
  const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                              .imageMemoryBarrierCount = 1,
                              .pImageMemoryBarriers = &move};
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace raymap::view
