#pragma once

#include <optional>
#include <span>
#include <vector>

#include "vulkan/device/device.h"

namespace raymap::vulkan {

/// Duration of a stage on the device, and its start by the device's clock.
struct StageTime {
  const char* name;
  double milliseconds;
  double start;  ///< Milliseconds since the first stage that the timer timed.
};

/// Counts ticks on from timestamps that begin again at 0 when their bits are used up.
class TickCounter {
 public:
  /// `validBits`: the number of lowest bits that are valid, 1 to 64.
  explicit TickCounter(uint32_t validBits) : mask_(~uint64_t{0} >> (64 - validBits)) {}

  /// Returns the ticks from the first timestamp to this one. It must be less than one round after the last
  /// one.
  uint64_t advanceTo(uint64_t timestamp) {
    if (last_) ticks_ += (timestamp - *last_) & mask_;
    last_ = timestamp;
    return ticks_;
  }

 private:
  uint64_t mask_;
  uint64_t ticks_ = 0;
  std::optional<uint64_t> last_;
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
  // At the last reset, and after the last reading; none if the device has no timestamps.
  std::optional<TickCounter> counter_, read_;
  QueryPool pool_;
  uint32_t stamps_ = 0;
  std::vector<StageTime> times_;
  std::vector<uint64_t> ticks_;
};

}  // namespace raymap::vulkan
