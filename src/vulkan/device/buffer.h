#pragma once

#include <algorithm>
#include <span>
#include <string>

#include "vulkan/device/device.h"

namespace raymap::vulkan {

class ScratchMemory;

/// Buffer that shaders read and write through its address. It keeps its memory when it shrinks, so work
/// repeated every frame allocates nothing. Moves only.
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  /// `name` appears in errors and validation messages.
  DeviceBuffer(Device& device, std::string name, MemoryUse use = MemoryUse::Device)
      : device_(&device), name_(std::move(name)), use_(use) {}
  /// Takes its memory from `scratch` unless that is null. Each `resize` then takes the next place in
  /// `scratch`, which only ever grows.
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

  /// Reserves memory for `count` elements. If the buffer grows, its contents become undefined. The device
  /// must not be using the buffer, and no recorded command may refer to it. Throws `Error(Memory)`, before
  /// allocating, if the device lacks the memory.
  template <class T>
  void resize(uint64_t count) {
    resizeBytes(count * sizeof(T));
  }
  /// Does so, and fills the elements. The host must see the buffer's memory.
  template <class Values>
  void fill(const Values& values) {
    const std::span from(values);
    resizeBytes(from.size_bytes());
    std::ranges::copy(std::as_bytes(from), mapped_);
  }
  void release();

  VkBuffer handle() const;
  /// Offset of the first byte in `handle()`; nonzero if the buffer has guards.
  VkDeviceSize offset() const;
  /// Address for shaders; 0 while the buffer has no memory.
  VkDeviceAddress address() const;
  uint64_t bytes() const { return size_; }
  /// Elements mapped for the host: those of Upload and ReadBack buffers, and of every buffer in memory that
  /// host and device share, which saves a copy. Empty for other buffers.
  template <class T>
  std::span<T> mapped() const {
    return {reinterpret_cast<T*>(mapped_), mapped_ ? size_ / sizeof(T) : 0};
  }

 private:
  void resizeBytes(uint64_t bytes);
  void allocate(uint64_t bytes);
  /// Returns the memory type.
  uint32_t allocateMemory();
  void swap(DeviceBuffer& other) noexcept;

  Device* device_ = nullptr;
  std::string name_;
  MemoryUse use_ = MemoryUse::Device;
  ScratchMemory* scratch_ = nullptr;
  uint64_t size_ = 0;
  uint64_t capacity_ = 0;
  uint64_t heldMemory_ = 0;
  VkDeviceSize offset_ = 0;
  size_t place_ = 0;  // Index in the scratch memory.
  VkDeviceAddress address_ = 0;
  std::byte* mapped_ = nullptr;
  Memory memory_;
  BufferHandle buffer_;  // Destroyed before its memory.
};

}  // namespace raymap::vulkan
