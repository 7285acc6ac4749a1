#pragma once

#include <raymap/vulkan.h>
#include <vulkan/vulkan.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace raymap::view {

/// Throws `Error` that says what was tried, unless the result is a success.
void check(VkResult result, const char* what);

/// Destroys a Vulkan object of a device.
template <class Handle>
struct Destroyer {
  VkDevice device = VK_NULL_HANDLE;
  void(VKAPI_PTR* destroy)(VkDevice, Handle, const VkAllocationCallbacks*) = nullptr;

  void operator()(Handle handle) const { destroy(device, handle, nullptr); }
};

/// A Vulkan object that is destroyed with its owner.
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Destroyer<Handle>>;

template <class Handle>
Owned<Handle> own(VkDevice device, Handle handle,
                  void(VKAPI_PTR* destroy)(VkDevice, Handle, const VkAllocationCallbacks*)) {
  return Owned<Handle>(handle, Destroyer<Handle>{device, destroy});
}

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

  /// Bytes of the device's own memory that this program holds, and those that it may hold.
  struct Memory {
    VkDeviceSize held = 0;
    VkDeviceSize most = 0;
  };
  /// Returns what the driver says about memory; none if it says nothing.
  std::optional<Memory> memory() const;

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
  bool isSoftware_ = false, knowsMemory_ = false;
  double nanosecondsPerTick_ = 0.0;
};

/// Makes all that was recorded before visible to all that follows, and to the host.
void barrier(VkCommandBuffer commands);

/// Moves an image to another layout, after all earlier commands.
void moveImage(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to,
               VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT);

}  // namespace raymap::view
