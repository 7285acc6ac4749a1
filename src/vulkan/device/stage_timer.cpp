#include "vulkan/device/stage_timer.h"

#include <raymap/error.h>

namespace raymap::vulkan {

StageTimer::StageTimer(Device& device) : device_(device.handle()), period_(device.limits().timestampPeriod) {
  if (period_ != 0.0) read_.emplace(device.limits().timestampBits);
  const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                   .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                   .queryCount = 2 * kMaxStages};
  create(pool_, device_, vkCreateQueryPool, info, "making timestamps");
  times_.reserve(kMaxStages);
  ticks_.reserve(2 * kMaxStages);
}

void StageTimer::reset(VkCommandBuffer buffer) {
  counter_ = read_;
  times_.clear();
  stamps_ = 0;
  vkCmdResetQueryPool(buffer, pool_.get(), 0, 2 * kMaxStages);
}

void StageTimer::start(VkCommandBuffer buffer, const char* name) {
  if (period_ == 0.0) return;
  if (times_.size() == kMaxStages)
    throw Error(ErrorCode::Usage, "more than " + std::to_string(kMaxStages) + " stages to time at once");
  times_.push_back({name, 0.0, 0.0});
  stamp(buffer);
}

void StageTimer::stop(VkCommandBuffer buffer) {
  if (period_ != 0.0) stamp(buffer);
}

void StageTimer::stamp(VkCommandBuffer buffer) {
  vkCmdWriteTimestamp2(buffer, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_.get(), stamps_++);
}

std::span<const StageTime> StageTimer::read() {
  if (times_.empty()) return {};
  ticks_.resize(stamps_);
  check(
      vkGetQueryPoolResults(device_, pool_.get(), 0, stamps_, ticks_.size() * sizeof(uint64_t), ticks_.data(),
                            sizeof(uint64_t), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
      "reading timestamps");
  read_ = counter_;
  const auto milliseconds = [&](uint64_t ticks) { return static_cast<double>(ticks) * period_ * 1e-6; };
  for (size_t i = 0; i < times_.size(); ++i) {
    const uint64_t start = read_->advanceTo(ticks_[2 * i]), stop = read_->advanceTo(ticks_[2 * i + 1]);
    times_[i].start = milliseconds(start);
    times_[i].milliseconds = milliseconds(stop - start);
  }
  return times_;
}

}  // namespace raymap::vulkan
