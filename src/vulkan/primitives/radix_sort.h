#pragma once

#include "vulkan/primitives/radix_sort_push.h"
#include "vulkan/primitives/scan.h"

namespace raymap::vulkan {

/// Sorts 32-bit values by unsigned 32-bit keys. Stable.
class RadixSort {
 public:
  /// Addresses of keys and values.
  struct Pairs {
    VkDeviceAddress keys = 0;
    VkDeviceAddress values = 0;
  };

  explicit RadixSort(Device& device);

  /// Reserves memory for counts up to `most`, which is at most 2^30. All previously recorded work must have
  /// completed.
  void reserve(uint32_t most);
  /// Sorts by the lowest `keyBits` bits, alternating between two places of the same size. Returns the place
  /// of the result: `pairs` if the number of passes, ceil(keyBits / 8), is even, else `other`.
  Pairs record(Commands& commands, Pairs pairs, Pairs other, uint32_t count, uint32_t keyBits);

 private:
  uint32_t groups(uint32_t count) const { return (count + tile_ - 1) / tile_; }

  uint32_t groupSize_;
  uint32_t tile_;  // Elements per group.
  uint32_t reserved_ = 0;
  Kernel<RadixSortPush> count_;
  Kernel<RadixSortPush> scatter_;
  Scan scan_;
  DeviceBuffer histogram_;
};

}  // namespace raymap::vulkan
