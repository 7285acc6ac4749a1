#pragma once

#include <vector>

#include "vulkan/device/buffer.h"

namespace raymap::vulkan {

/// Temporary memory shared by consecutive phases. The first buffers of all phases lie in the same place, the
/// second ones in another, and so on. Each phase overwrites the contents of the one before.
class ScratchMemory {
 public:
  explicit ScratchMemory(Device& device) : device_(&device) {}
  // Buffers keep its address.
  ScratchMemory(const ScratchMemory&) = delete;
  ScratchMemory& operator=(const ScratchMemory&) = delete;

  /// Starts another phase: buffers that are sized from now on belong to it. Places below `first` keep their
  /// contents.
  void startPhase(size_t first = 0) { next_ = first; }
  /// Index of the place that the next buffer takes.
  size_t next() const { return next_; }
  /// Returns the next place, with at least `bytes` bytes. Its previous contents may move. The preconditions
  /// and errors are those of `DeviceBuffer::resize`.
  size_t reserveNext(uint64_t bytes);
  const DeviceBuffer& at(size_t place) const { return places_[place]; }

 private:
  Device* device_;
  std::vector<DeviceBuffer> places_;
  size_t next_ = 0;
};

}  // namespace raymap::vulkan
