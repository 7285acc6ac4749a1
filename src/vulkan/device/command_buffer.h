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
  /// Submits what was recorded since the last part, and returns the number of the part. `commands` then
  /// record the rest, which `submit` submits.
  size_t submitPart(Commands& commands);
  /// Waits for a part and those before. The host can then read their results.
  void waitForPart(size_t part);
  /// Waits for all parts that were submitted.
  void waitForParts();
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
  void waitFor(VkFence fence);
  void startRecording();

  CommandPool pool_;
  VkCommandBuffer buffer() const { return buffers_[parts_ % kBuffers]; }

  static constexpr size_t kBuffers = 4;  // Parts take turns.
  Fence fence_;
  std::array<Fence, kBuffers> partFences_;
  StageTimer timer_;
  std::array<VkCommandBuffer, kBuffers> buffers_{};  // Owned by the pool.
  size_t parts_ = 0;                                 // Submitted since `begin`.
};

}  // namespace raymap::vulkan
