#pragma once

#include <raymap/vulkan.h>
#include <vulkan/vulkan.h>

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace raymap::view {

/// Throws `Error` that says what was tried, unless the result is a success.
void check(VkResult result, const char* what);

/// A Vulkan object that is destroyed with its owner.
template <class Handle>
class Owned {
 public:
  using Destroy = void(VKAPI_PTR*)(VkDevice, Handle, const VkAllocationCallbacks*);

  Owned() = default;
  Owned(VkDevice device, Handle handle, Destroy destroy)
      : device_(device), handle_(handle), destroy_(destroy) {}
  ~Owned() {
    if (handle_) destroy_(device_, handle_, nullptr);
  }
  Owned(Owned&& other) noexcept { swap(other); }
  Owned& operator=(Owned&& other) noexcept {
    Owned(std::move(other)).swap(*this);
    return *this;
  }
  Handle get() const { return handle_; }
  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

 private:
  void swap(Owned& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
    std::swap(destroy_, other.destroy_);
  }

  VkDevice device_ = VK_NULL_HANDLE;
  Handle handle_ = VK_NULL_HANDLE;
  Destroy destroy_ = nullptr;
};

struct Buffer {
  Owned<VkDeviceMemory> memory;
  Owned<VkBuffer> handle;  ///< Declared after its memory, so destroyed before it.
  VkDeviceSize bytes = 0;
  void* mapped = nullptr;       ///< For the host, of buffers that it sees.
  VkDeviceAddress address = 0;  ///< For shaders.

  vulkan::BufferRange range() const { return {handle.get(), 0}; }
};

struct Image {
  Owned<VkDeviceMemory> memory;
  Owned<VkImage> handle;
  Owned<VkImageView> view;
  VkExtent2D size = {};
};

/// An instance, a device that can present and one queue of it.
class Gpu {
 public:
  using MakeSurface = std::function<VkSurfaceKHR(VkInstance)>;

  /// `device` is a value of `MachineOptions::device`. All but vulkan:K choose the first device that is no
  /// software, else the first of any kind. Throws `Error`: Usage if there is no such device, Unsupported if
  /// it cannot present.
  Gpu(const std::string& device, std::span<const char* const> extensions, const MakeSurface& makeSurface);
  ~Gpu();
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  const vulkan::DeviceHandles& handles() const { return handles_; }
  VkDevice device() const { return handles_.device; }
  VkSurfaceKHR surface() const { return surface_; }
  const std::string& name() const { return name_; }
  bool isSoftware() const { return isSoftware_; }
  /// Returns the nanoseconds of a step of its clock; 0 if it has none.
  double nanosecondsPerTick() const { return nanosecondsPerTick_; }

  /// Makes a buffer in the device's own memory, or in memory that the host sees.
  Buffer makeBuffer(VkDeviceSize bytes, bool isForHost = false) const;
  /// Makes a buffer for the host that holds these bytes.
  Buffer stage(std::span<const std::byte> bytes) const;
  Image makeImage(VkExtent2D size, VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect) const;
  Owned<VkShaderModule> makeShader(std::span<const uint32_t> code) const;
  void waitIdle() const { check(vkDeviceWaitIdle(handles_.device), "waiting for the device"); }

 private:
  void makeInstance(std::span<const char* const> extensions);
  void choosePhysicalDevice(const std::string& device);
  void makeDevice();
  uint32_t memoryType(uint32_t allowed, VkMemoryPropertyFlags flags) const;
  Owned<VkDeviceMemory> allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags flags,
                                 bool hasAddress) const;

  vulkan::DeviceHandles handles_;
  VkSurfaceKHR surface_ = VK_NULL_HANDLE;
  std::string name_;
  bool isSoftware_ = false;
  double nanosecondsPerTick_ = 0.0;
};

/// Makes all that was recorded before visible to all that follows, and to the host.
void barrier(VkCommandBuffer commands);

/// Moves an image to another layout, after all earlier commands.
void moveImage(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
               VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT);

}  // namespace raymap::view
