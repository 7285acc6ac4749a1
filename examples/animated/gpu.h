#pragma once

// Parts that any program with Vulkan has already: a device, buffers, a command buffer, timestamps.
// Only `makeDevice` in gpu.cpp knows that raymap is going to use the device.

#include <raymap/vulkan.h>
#include <vulkan/vulkan.h>

#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Throws a `raymap::Error` that says what was tried, unless the result is a success.
void check(VkResult result, const char* what);

struct Buffer {
  VkBuffer handle = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkDeviceSize bytes = 0;
  void* mapped = nullptr;  ///< For the host, of buffers that it sees.

  raymap::vulkan::BufferRange range() const { return {handle, 0}; }
};

class Gpu {
 public:
  /// The device of that number among the driver's, else the first real GPU, else the first of any kind.
  explicit Gpu(std::optional<uint32_t> index);
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  const raymap::vulkan::DeviceHandles& handles() const { return handles_; }
  const std::string& name() const { return name_; }

  /// Lives as long as the Gpu, in the device's own memory or in memory that the host sees.
  Buffer makeBuffer(VkDeviceSize bytes, bool isForHost = false);
  /// A buffer on the device, filled once.
  template <class T>
  Buffer upload(const std::vector<T>& values) {
    return upload(std::as_bytes(std::span(values)));
  }
  Buffer upload(std::span<const std::byte> bytes);

  /// The one command buffer, empty.
  VkCommandBuffer begin();
  /// Notes when the device gets here.
  void stamp();
  void submitAndWait();
  /// Milliseconds between the stamps of what ran last; none on a device without timestamps.
  std::vector<double> times() const;

 private:
  static constexpr uint32_t kMaxStamps = 8;

  void makeInstance();
  void choosePhysicalDevice(std::optional<uint32_t> index);
  void makeDevice();
  void makeCommandBuffer();
  void destroy(const Buffer& buffer);
  uint32_t memoryType(uint32_t allowed, VkMemoryPropertyFlags flags) const;

  raymap::vulkan::DeviceHandles handles_;
  std::string name_;
  double nanosecondsPerTick_ = 0.0;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkQueryPool stamps_ = VK_NULL_HANDLE;
  uint32_t stampCount_ = 0;
  std::vector<Buffer> buffers_;
};
