#pragma once

#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan/primitives/scan_push.h"

namespace raymap::vulkan {

/// Exclusive prefix sums of 32-bit numbers, modulo 2^32.
class Scan {
 public:
  explicit Scan(Device& device);

  /// Makes room for counts of up to `most`, at most 2^31. Nothing recorded before may still have to run.
  void reserve(uint32_t most);
  /// Writes what comes before each value to `sums`, which may be `values` itself or apart from it, and the
  /// total after the last: `sums` holds one element more. Addresses are multiples of 16.
  void record(Commands& commands, VkDeviceAddress values, VkDeviceAddress sums, Count count);

 private:
  static constexpr uint32_t kMaxLevels = 3;  // 2^12, 2^24, 2^36 elements.

  /// The kernels' parameters at a level: that above works on the sums of this one's blocks.
  ScanPush push(uint32_t level, uint32_t levels, VkDeviceAddress values, VkDeviceAddress sums,
                Count count) const;
  void dispatch(Commands& commands, Kernel<ScanPush>& kernel, const ScanPush& push, uint32_t level);

  uint32_t reserved_ = 0;
  Kernel<ScanPush> reduce_;
  Kernel<ScanPush> blocks_;
  DispatchArguments arguments_;
  DeviceBuffer blockSums_[kMaxLevels - 1];
};

}  // namespace raymap::vulkan
