#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/primitives/scan_push.h"

namespace raymap::vulkan {

/// Exclusive prefix sums of 32-bit numbers, modulo 2^32.
class Scan {
 public:
  explicit Scan(Device& device);

  /// Reserves memory for counts up to `most`, which is at most 2^31. All previously recorded work must have
  /// completed.
  void reserve(uint32_t most);
  /// Writes the sum before each value to `sums`, and the total after the last: `sums` holds one element more.
  /// It may be `values` itself; otherwise the two must not overlap. Addresses are multiples of 16.
  void record(Commands& commands, VkDeviceAddress values, VkDeviceAddress sums, uint32_t count);

 private:
  static constexpr uint32_t kMaxLevels = 3;  // For 2^12, 2^24, 2^36 elements.

  /// Returns the kernels' parameters for a level. The level above works on the sums of this level's blocks.
  ScanPush push(uint32_t level, uint32_t levels, VkDeviceAddress values, VkDeviceAddress sums,
                uint32_t count) const;
  static void dispatch(Commands& commands, Kernel<ScanPush>& kernel, const ScanPush& push);

  uint32_t reserved_ = 0;
  Kernel<ScanPush> reduce_;
  Kernel<ScanPush> blocks_;
  DeviceBuffer blockSums_[kMaxLevels - 1];
};

}  // namespace raymap::vulkan
