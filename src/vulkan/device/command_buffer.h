#pragma once

#include "vulkan/device/commands.h"

namespace raymap::vulkan {

/// A command buffer of our own, recorded anew each time and waited for.
class CommandBuffer {
 public:
  explicit CommandBuffer(Device& device);

  /// Forgets what was recorded; the result is good until `submitAndWait`.
  Commands begin();
  /// Runs what was recorded; the host then sees what it wrote.
  void submitAndWait();
  /// Of the stages of the last run.
  std::span<const StageTime> times() { return timer_.read(); }

 private:
  Device* device_;
  CommandPool pool_;
  Fence fence_;
  StageTimer timer_;
  VkCommandBuffer buffer_ = VK_NULL_HANDLE;  // The pool's.
};

}  // namespace raymap::vulkan
