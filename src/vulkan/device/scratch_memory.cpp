#include "vulkan/device/scratch_memory.h"

#include <algorithm>

namespace raymap::vulkan {

size_t ScratchMemory::reserveNext(uint64_t bytes) {
  if (next_ == places_.size()) places_.emplace_back(*device_, "scratch memory " + std::to_string(next_));
  DeviceBuffer& place = places_[next_];
  place.resize<std::byte>(std::max(bytes, place.bytes()));
  return next_++;
}

}  // namespace raymap::vulkan
