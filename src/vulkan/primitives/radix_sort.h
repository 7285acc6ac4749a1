#pragma once

#include "vulkan/primitives/radix_sort_push.h"
#include "vulkan/primitives/scan.h"

namespace raymap::vulkan {

/// Sorts 32-bit values by unsigned keys of one or two 32-bit words, the lower first. Stable.
class RadixSort {
 public:
  /// Where keys and values lie.
  struct Pairs {
    VkDeviceAddress keys = 0;
    VkDeviceAddress values = 0;
  };

  explicit RadixSort(Device& device, uint32_t keyWords = 1);

  /// Makes room for counts of up to `most`, at most 2^30. Nothing recorded before may still have to run.
  void reserve(uint32_t most);
  /// Sorts by the lowest `keyBits` bits, back and forth between two places of the same size: gives the one
  /// that holds the result, `pairs` if the number of passes, ceil(keyBits / 8), is even.
  Pairs record(Commands& commands, Pairs pairs, Pairs other, Count count, uint32_t keyBits);

 private:
  void pass(Commands& commands, const RadixSortPush& push);
  void dispatch(Commands& commands, Kernel<RadixSortPush>& kernel, const RadixSortPush& push);
  uint32_t groups(uint32_t count) const { return (count + tile_ - 1) / tile_; }

  uint32_t groupSize_;
  uint32_t tile_;  // Elements of a group.
  uint32_t keyWords_;
  uint32_t reserved_ = 0;
  Kernel<RadixSortPush> count_;
  Kernel<RadixSortPush> scatter_;
  Scan scan_;
  DispatchArguments arguments_;
  DeviceBuffer histogram_;
};

}  // namespace raymap::vulkan
