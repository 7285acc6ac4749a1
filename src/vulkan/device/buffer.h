#pragma once

#include <span>
#include <string>

#include "vulkan/device/device.h"

namespace raymap::vulkan {

class ScratchMemory;

/// A buffer that shaders reach by its address. Its memory is kept when it shrinks, so that work repeated
/// every frame allocates nothing. Moves only.
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  /// `name` is what errors and validation messages call it.
  DeviceBuffer(Device& device, std::string name, MemoryUse use = MemoryUse::Device)
      : device_(&device), name_(std::move(name)), use_(use) {}
  /// Lies in `scratch` if that is not null: then `resize` takes the next place there, and grows that at most.
  DeviceBuffer(Device& device, std::string name, ScratchMemory* scratch)
      : DeviceBuffer(device, std::move(name)) {
    scratch_ = scratch;
  }
  DeviceBuffer(DeviceBuffer&& other) noexcept { swap(other); }
  DeviceBuffer& operator=(DeviceBuffer&& other) noexcept {
    DeviceBuffer(std::move(other)).swap(*this);
    return *this;
  }
  ~DeviceBuffer() { release(); }

  /// Room for `count` elements; contents are undefined afterwards if it grew. The device must not be using
  /// the buffer, nor a recorded command refer to it. Throws `Error(Memory)` before it allocates.
  template <class T>
  void resize(uint64_t count) {
    resizeBytes(count * sizeof(T));
  }
  void release();

  VkBuffer handle() const;
  /// Where its first byte lies in `handle()`: not at 0 if there are guards.
  VkDeviceSize offset() const;
  /// What shaders take; 0 while it has no memory.
  VkDeviceAddress address() const;
  uint64_t bytes() const { return size_; }
  /// The elements as the host sees them: of buffers for Upload and ReadBack, and of all where host and device
  /// share their memory, which saves the copy. Else none.
  template <class T>
  std::span<T> mapped() const {
    return {reinterpret_cast<T*>(mapped_), mapped_ ? size_ / sizeof(T) : 0};
  }

 private:
  void resizeBytes(uint64_t bytes);
  void allocate(uint64_t bytes);
  /// Gives the memory type it took.
  uint32_t allocateMemory();
  void map();
  void swap(DeviceBuffer& other) noexcept;

  Device* device_ = nullptr;
  std::string name_;
  MemoryUse use_ = MemoryUse::Device;
  ScratchMemory* scratch_ = nullptr;
  uint64_t size_ = 0;
  uint64_t capacity_ = 0;
  uint64_t heldMemory_ = 0;
  VkDeviceSize offset_ = 0;
  size_t place_ = 0;  // In the scratch memory.
  VkDeviceAddress address_ = 0;
  std::byte* mapped_ = nullptr;
  Memory memory_;
  BufferHandle buffer_;  // Destroyed before its memory.
};

}  // namespace raymap::vulkan
