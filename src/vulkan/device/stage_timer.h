#pragma once

#include <span>
#include <vector>

#include "vulkan/device/device.h"

namespace raymap::vulkan {

/// Duration of a stage on the device, and its start by the device's clock.
struct StageTime {
  const char* name;
  double milliseconds;
  double start;  ///< Milliseconds since an arbitrary time.
};

/// Timestamps before and after each stage of one command buffer. Without timestamps on the device there are
/// no times.
class StageTimer {
 public:
  static constexpr uint32_t kMaxStages = 64;

  explicit StageTimer(Device& device);

  void reset(VkCommandBuffer buffer);
  /// Starts a stage. `name` must live until the times are read.
  void start(VkCommandBuffer buffer, const char* name);
  void stop(VkCommandBuffer buffer);
  /// Returns the times of the stages recorded since `reset`, in order. The device must have completed them.
  std::span<const StageTime> read();

 private:
  void stamp(VkCommandBuffer buffer);

  VkDevice device_;
  double period_;
  QueryPool pool_;
  uint32_t stamps_ = 0;
  std::vector<StageTime> times_;
  std::vector<uint64_t> ticks_;
};

}  // namespace raymap::vulkan
