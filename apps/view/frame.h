#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gpu.h"

namespace raymap::view {

/// The command buffer, fence, semaphore and timestamps of one of the frames in flight.
class Frame {
 public:
  explicit Frame(const Gpu& gpu);

  /// Waits until the device has ended this frame's last work, and begins new work.
  void begin();
  /// Ends the work and gives it to the device.
  void submit(VkSemaphore isDrawn);

  VkCommandBuffer commands() const { return commands_; }
  VkSemaphore isFree() const { return isFree_.get(); }
  /// Names the time of all work since the last stamp.
  void stamp(const char* stage);
  size_t pixels = 0;  ///< Number of pixels that the stage "picture" draws.

  /// Keeps a buffer until the device has ended this work.
  const Buffer& keep(Buffer buffer) { return kept_.emplace_back(std::move(buffer)); }
  /// Copies bytes of the host to the device within this work. Their number is a multiple of 4.
  void upload(std::span<const std::byte> bytes, const Buffer& to);

  /// A stage of the work and its time.
  struct Time {
    const char* stage;
    double milliseconds;
  };
  /// Returns the times of the work that `begin` waited for; none if the device has no clock.
  const std::vector<Time>& times() const { return times_; }

 private:
  void readTimes();

  static constexpr uint32_t kMaxStamps = 16;
  const Gpu& gpu_;
  Owned<VkCommandPool> pool_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  Owned<VkFence> isDone_;
  Owned<VkSemaphore> isFree_;
  Owned<VkQueryPool> stamps_;
  std::vector<const char*> stages_;
  std::vector<Time> times_;
  std::vector<Buffer> kept_;
};

}  // namespace raymap::view
