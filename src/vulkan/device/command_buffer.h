#pragma once

#include "vulkan/device/commands.h"

namespace raymap::vulkan {

/// Command buffer of our own. It is recorded anew each time, and the host waits for its completion.
class CommandBuffer {
 public:
  explicit CommandBuffer(Device& device);

  /// Discards what was recorded. The result is valid until `submit`.
  Commands begin();
  /// Submits what was recorded.
  void submit();
  /// Waits for what was submitted. The host can then read the results.
  void wait();
  void submitAndWait() {
    submit();
    wait();
  }
  /// Returns the times of the last run's stages.
  std::span<const StageTime> times() { return timer_.read(); }

 private:
  Device* device_;
  CommandPool pool_;
  Fence fence_;
  StageTimer timer_;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;  // Owned by the pool.
};

}  // namespace raymap::vulkan
