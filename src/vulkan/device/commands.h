#pragma once

#include <functional>
#include <initializer_list>
#include <utility>

#include "vulkan/device/buffer.h"
#include "vulkan/device/kernel.h"
#include "vulkan/device/stage_timer.h"

namespace raymap::vulkan {

/// Makes the results of all earlier commands, including others on the queue, visible to commands recorded
/// afterwards.
void waitForAll(VkCommandBuffer buffer);
/// Makes the results recorded before visible to all later commands, and to the host once the work is done.
void showAll(VkCommandBuffer buffer);

/// Listens while commands are recorded. Each function may submit what is recorded so far and let the
/// `Commands` continue in another command buffer.
class RecordingListener {
 public:
  virtual ~RecordingListener() = default;
  /// Called before more invocations are recorded than the device should work on without a pause.
  virtual void onMuchWork() = 0;
  /// Called with the share of the stage that is done once all recorded work is.
  virtual void onProgress(double done) = 0;
};

/// Records into a command buffer, ours or the caller's. A full barrier precedes every command, so each one
/// sees the results of all commands before it (docs/dev/decisions/vulkan_memory.md). Records no allocation.
class Commands {
 public:
  /// `timer` may be null; stages are then not timed.
  Commands(VkCommandBuffer buffer, VkPipelineLayout layout, StageTimer* timer);

  VkCommandBuffer handle() const { return buffer_; }
  /// Records into another command buffer from now on.
  void continueIn(VkCommandBuffer buffer) { buffer_ = buffer; }
  /// Sets the listener; null for none.
  void listen(RecordingListener* listener) { listener_ = listener; }
  /// Tells the listener what share of the stage is recorded. Not allowed within `concurrent`.
  void report(double done) {
    if (listener_) listener_->onProgress(done);
  }

  /// Runs at least `invocations` invocations, in groups of the kernel's size. Shaders check bounds. Many
  /// invocations become several dispatches that may run at the same time. Each may take as long as `weight`
  /// invocations of the exact distance, at most 64.
  template <class Push>
  void dispatch(Kernel<Push>& kernel, const Push& push, uint64_t invocations, uint64_t weight = 1) {
    dispatchBytes(kernel, &push, sizeof push, invocations, weight);
  }
  /// Runs as many groups as the `VkDispatchIndirectCommand` at `offset` in `arguments` states. With `isMore`
  /// it may run at the same time as the command before.
  template <class Push>
  void dispatchIndirect(Kernel<Push>& kernel, const Push& push, const DeviceBuffer& arguments,
                        VkDeviceSize offset, bool isMore = false) {
    if (!isMore) barrier();
    dispatchIndirectBytes(kernel, &push, sizeof push, arguments, offset);
  }
  void fill(const DeviceBuffer& buffer, uint32_t value) {
    fill(buffer.handle(), buffer.offset(), buffer.bytes(), value);
  }
  void fill(VkBuffer buffer, VkDeviceSize offset, VkDeviceSize bytes, uint32_t value);
  /// Writes a value known when recording: at most 65,536 bytes, a multiple of 4.
  template <class T>
  void update(const DeviceBuffer& buffer, const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= 65536 && sizeof(T) % 4 == 0);
    updateBytes(buffer, &value, sizeof value);
  }
  void copy(const DeviceBuffer& from, const DeviceBuffer& to, VkDeviceSize bytes) {
    copy(from, to.handle(), to.offset(), bytes);
  }
  /// Copies from byte `first` of `from` on.
  void copy(const DeviceBuffer& from, VkBuffer to, VkDeviceSize offset, VkDeviceSize bytes,
            VkDeviceSize first = 0);
  /// Copies to an image with one layer and one level, in VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL.
  void copy(const DeviceBuffer& from, VkImage to, const VkExtent3D& extent);

  /// Places one barrier before all the commands that `work` records; they may run at the same time. No
  /// command may write memory that another one reads or writes. `work` may call it again.
  template <class Work>
  void concurrent(Work&& work) {
    barrier();
    const bool isOuter = !std::exchange(isConcurrent_, true);
    work();
    isConcurrent_ = !isOuter;
  }

  /// Records independent chains of commands: one barrier precedes the first steps of all, another one the
  /// second ones, and so on. No chain may write memory that another one reads or writes. Each is called once
  /// for every step and must ask for the same commands each time.
  void lockstep(std::initializer_list<std::function<void()>> chains);

  /// Times what is recorded until `stopStage`. Stages do not nest.
  void startStage(const char* name) {
    if (timer_) timer_->start(buffer_, name);
  }
  void stopStage() {
    if (timer_) timer_->stop(buffer_);
  }

 private:
  void dispatchBytes(ComputePipeline& kernel, const void* push, uint32_t pushBytes, uint64_t invocations,
                     uint64_t weight);
  void dispatchIndirectBytes(ComputePipeline& kernel, const void* push, uint32_t pushBytes,
                             const DeviceBuffer& arguments, VkDeviceSize offset);
  void updateBytes(const DeviceBuffer& buffer, const void* bytes, uint32_t size);
  bool makeRoom(uint64_t invocations);
  void bind(ComputePipeline& kernel, const void* push, uint32_t pushBytes);
  void barrier();
  /// Returns whether commands belong to the step that is being recorded.
  bool isDue() const { return stepOfChain_ == step_; }

  VkCommandBuffer buffer_;
  VkPipelineLayout layout_;
  StageTimer* timer_;
  RecordingListener* listener_ = nullptr;
  uint64_t recorded_ = 0;  // Invocations in this command buffer, as far as the host knows them.
  bool isConcurrent_ = false;
  size_t step_ = 0;         // Step that is being recorded in lockstep, from 1 on.
  size_t stepOfChain_ = 0;  // Step in lockstep that the next commands belong to.
};

}  // namespace raymap::vulkan
