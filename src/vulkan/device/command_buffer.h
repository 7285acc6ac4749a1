#pragma once

#include <array>

#include "vulkan/device/commands.h"

namespace raymap::vulkan {

/// Commands of our own. They are recorded anew each time, and the host waits for their completion.
class CommandBuffer {
 public:
  explicit CommandBuffer(Device& device);
  ~CommandBuffer();
  CommandBuffer(const CommandBuffer&) = delete;
  CommandBuffer& operator=(const CommandBuffer&) = delete;

  /// Discards what was recorded. The result is valid until `submit`.
  Commands begin();
  /// Submits what was recorded so far. `commands` then record the rest, which `submit` submits.
  void submitPart(Commands& commands);
  /// Waits for the last part that was submitted. The host can then read its results.
  void waitForPart();
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
  void submit(VkFence fence);
  void startRecording();

  CommandPool pool_;
  Fence fence_, partFence_;
  StageTimer timer_;
  std::array<VkCommandBuffer, 2> buffers_{};  // Owned by the pool. The first is recorded.
  bool isPartSubmitted_ = false;
};

}  // namespace raymap::vulkan
