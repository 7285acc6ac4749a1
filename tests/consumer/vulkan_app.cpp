// A field that never leaves the GPU: the mesh lies in buffers of ours, the field comes to lie in another, on
// a device of ours, by a command buffer of ours. Only to check it, this looks at two samples from the host.

#include <raymap/raymap.h>
#include <raymap/vulkan.h>
#include <vulkan/vulkan.h>

#include <cstdio>
#include <cstring>
#include <span>
#include <stdexcept>

namespace {

void check(VkResult result) {
  if (result != VK_SUCCESS) throw std::runtime_error("Vulkan failed");
}

/// A device with one queue that computes, made with what raymap needs. Ends with the program.
raymap::vulkan::DeviceHandles makeDevice() {
  raymap::vulkan::DeviceHandles handles;
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .apiVersion = VK_API_VERSION_1_3};
  const VkInstanceCreateInfo instance{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                      .pApplicationInfo = &application};
  check(vkCreateInstance(&instance, nullptr, &handles.instance));
  uint32_t one = 1;
  vkEnumeratePhysicalDevices(handles.instance, &one, &handles.physical);
  if (one == 0) throw std::runtime_error("no device");

  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                       .pNext = &v13};
  VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &v12};
  raymap::vulkan::requireFeatures(features.features, v12, v13);
  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = handles.queueFamily,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority};
  const VkDeviceCreateInfo device{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &features,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue};
  check(vkCreateDevice(handles.physical, &device, nullptr, &handles.device));
  vkGetDeviceQueue(handles.device, handles.queueFamily, 0, &handles.queue);
  return handles;
}

/// A buffer that shaders reach by its address, and the host too.
struct Buffer {
  VkBuffer handle = VK_NULL_HANDLE;
  void* memory = nullptr;
};

Buffer makeBuffer(const raymap::vulkan::DeviceHandles& on, VkDeviceSize bytes,
                  const void* contents = nullptr) {
  Buffer buffer;
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .size = bytes,
                                .usage = VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT};
  check(vkCreateBuffer(on.device, &info, nullptr, &buffer.handle));
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(on.device, buffer.handle, &needs);
  VkPhysicalDeviceMemoryProperties types;
  vkGetPhysicalDeviceMemoryProperties(on.physical, &types);
  constexpr VkMemoryPropertyFlags kHosts =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  uint32_t type = 0;
  while ((needs.memoryTypeBits >> type & 1) == 0 ||
         (types.memoryTypes[type].propertyFlags & kHosts) != kHosts)
    ++type;
  const VkMemoryAllocateFlagsInfo flags{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                        .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
  const VkMemoryAllocateInfo memory{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                    .pNext = &flags,
                                    .allocationSize = needs.size,
                                    .memoryTypeIndex = type};
  VkDeviceMemory allocation = VK_NULL_HANDLE;
  check(vkAllocateMemory(on.device, &memory, nullptr, &allocation));
  check(vkBindBufferMemory(on.device, buffer.handle, allocation, 0));
  check(vkMapMemory(on.device, allocation, 0, VK_WHOLE_SIZE, 0, &buffer.memory));
  if (contents) std::memcpy(buffer.memory, contents, bytes);
  return buffer;
}

template <class Record>
void run(const raymap::vulkan::DeviceHandles& on, Record&& record) {
  const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                         .queueFamilyIndex = on.queueFamily};
  VkCommandPool pool = VK_NULL_HANDLE;
  check(vkCreateCommandPool(on.device, &poolInfo, nullptr, &pool));
  const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = pool,
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = 1};
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(vkAllocateCommandBuffers(on.device, &info, &commands));
  const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  check(vkBeginCommandBuffer(commands, &begin));
  record(commands);
  check(vkEndCommandBuffer(commands));
  const VkSubmitInfo submit{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
  check(vkQueueSubmit(on.queue, 1, &submit, VK_NULL_HANDLE));
  check(vkQueueWaitIdle(on.queue));
}

bool makeField() {
  const raymap::Mesh mesh =
      raymap::makeMesh(std::vector<glm::dvec3>{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                       {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
  const raymap::Grid grid = raymap::fitGrid(mesh, {.resolution = 21});
  const raymap::vulkan::DeviceHandles device = makeDevice();
  const Buffer vertices = makeBuffer(device, sizeof(glm::vec3) * mesh.vertices.size(), mesh.vertices.data());
  const Buffer triangles =
      makeBuffer(device, sizeof(glm::uvec3) * mesh.triangles.size(), mesh.triangles.data());
  const Buffer distance = makeBuffer(device, sizeof(float) * grid.sampleCount());

  // Once.
  raymap::vulkan::Generator generator(device);
  generator.reserve({.vertices = 4, .triangles = 4, .dims = grid.dims});
  // Every frame.
  run(device, [&](VkCommandBuffer commands) {
    generator.record(commands,
                     {.vertices = {vertices.handle},
                      .vertexCount = 4,
                      .triangles = {triangles.handle},
                      .triangleCount = 4,
                      .origin = mesh.origin},
                     grid, {}, {.distance = {distance.handle}});
    // Whatever else is recorded here finds the field in `distance`.
  });
  if (const raymap::vulkan::Status status = generator.status(); status.error) throw *status.error;

  const std::span samples(static_cast<const float*>(distance.memory), grid.sampleCount());
  std::printf("on the device: middle %g, corner %g\n", double(samples[grid.index(grid.dims / 2)]),
              double(samples[0]));
  return samples[grid.index(grid.dims / 2)] < 0.0f && samples[0] > 0.0f;
}

}  // namespace

int main() {
  try {
    return makeField() ? 0 : 1;
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 77;  // Perhaps there is no device here.
  }
}
