#pragma once

#include <vector>

#include "vulkan/device/buffer.h"

namespace raymap::vulkan {

/// Memory for what is needed only for a while: the first buffer of each phase lies in the same place, the
/// second ones in another, and so on. A phase's contents are lost when the next one writes its own.
class ScratchMemory {
 public:
  explicit ScratchMemory(Device& device) : device_(&device) {}
  // Buffers refer to it.
  ScratchMemory(const ScratchMemory&) = delete;
  ScratchMemory& operator=(const ScratchMemory&) = delete;

  /// Buffers that are sized from now on belong to another phase.
  void startPhase() { next_ = 0; }
  /// The next place, with room for so many bytes. What has been there may move; else as
  /// `DeviceBuffer::resize`.
  size_t take(uint64_t bytes);
  const DeviceBuffer& at(size_t place) const { return places_[place]; }

 private:
  Device* device_;
  std::vector<DeviceBuffer> places_;
  size_t next_ = 0;
};

}  // namespace raymap::vulkan
