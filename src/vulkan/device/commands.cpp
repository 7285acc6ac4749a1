#include "vulkan/device/commands.h"

#include <raymap/error.h>

#include <algorithm>

#include "base/ceil_div.h"
#include "vulkan/device/dispatch_limits.h"

namespace raymap::vulkan {

namespace {

/// Invocations of one submission: systems also limit the time of these.
constexpr uint64_t kMostSubmitted = uint64_t{1} << 27;

constexpr VkPipelineStageFlags2 kWork =
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
constexpr VkAccessFlags2 kWrites = VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
constexpr VkAccessFlags2 kReads =
    VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT;
constexpr VkPipelineStageFlags2 kWorkAndArguments = kWork | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;

void barrierBetween(VkCommandBuffer buffer, VkPipelineStageFlags2 before, VkAccessFlags2 written,
                    VkPipelineStageFlags2 after, VkAccessFlags2 accessed) {
  const VkMemoryBarrier2 memory{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                .srcStageMask = before,
                                .srcAccessMask = written,
                                .dstStageMask = after,
                                .dstAccessMask = accessed};
  const VkDependencyInfo info{
      .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &memory};
  vkCmdPipelineBarrier2(buffer, &info);
}

}  // namespace

void waitForAll(VkCommandBuffer buffer) {
  barrierBetween(buffer, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT,
                 kWorkAndArguments, kWrites | kReads);
}

void showAll(VkCommandBuffer buffer) {
  barrierBetween(buffer, kWork, kWrites, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
                 VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_HOST_READ_BIT |
                     VK_ACCESS_2_HOST_WRITE_BIT);
}

Commands::Commands(VkCommandBuffer buffer, VkPipelineLayout layout, StageTimer* timer)
    : buffer_(buffer), layout_(layout), timer_(timer) {
  if (timer_) timer_->reset(buffer_);
}

void Commands::dispatchBytes(ComputePipeline& kernel, const void* push, uint32_t pushBytes,
                             uint64_t invocations, uint64_t weight) {
  if (invocations == 0) return;
  // Shaders number their invocations with 32 bits.
  const uint64_t groups = ceilDiv(invocations, kernel.groupSize());
  const uint64_t mostGroups = std::max<uint64_t>(kMostInvocations / kernel.groupSize() / weight, 1);
  const uint64_t y = ceilDiv(groups, std::min<uint64_t>(kMaxGroups, mostGroups));
  const uint64_t x = ceilDiv(groups, y);
  if (x * y * kernel.groupSize() > uint64_t{1} << 32)
    throw Error(ErrorCode::Unsupported, "a kernel would run " + std::to_string(invocations) +
                                            " times, at most 2^32 can be numbered; use a lower resolution");
  const uint64_t mostRows = mostGroups / x;
  for (uint64_t row = 0; row < y; row += mostRows) {
    const uint64_t rows = std::min(mostRows, y - row), added = x * rows * kernel.groupSize() * weight;
    if (makeRoom(added) || row == 0) {
      barrier();
      bind(kernel, push, pushBytes);
    }
    if (!isDue()) return;
    recorded_ += added;
    vkCmdDispatchBase(buffer_, 0, static_cast<uint32_t>(row), 0, static_cast<uint32_t>(x),
                      static_cast<uint32_t>(rows), 1);
  }
}

/// Returns whether recording continues in a new command buffer.
bool Commands::makeRoom(uint64_t invocations) {
  if (!listener_ || isConcurrent_ || step_ > 0 || recorded_ + invocations <= kMostSubmitted) return false;
  listener_->onMuchWork();
  recorded_ = 0;
  return true;
}

void Commands::dispatchIndirectBytes(ComputePipeline& kernel, const void* push, uint32_t pushBytes,
                                     const DeviceBuffer& arguments, VkDeviceSize offset) {
  bind(kernel, push, pushBytes);
  if (isDue()) vkCmdDispatchIndirect(buffer_, arguments.handle(), arguments.offset() + offset);
}

void Commands::bind(ComputePipeline& kernel, const void* push, uint32_t pushBytes) {
  if (!isDue()) return;
  vkCmdBindPipeline(buffer_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.handle());
  vkCmdPushConstants(buffer_, layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, pushBytes, push);
}

void Commands::fill(VkBuffer filled, VkDeviceSize offset, VkDeviceSize bytes, uint32_t value) {
  if (bytes == 0) return;
  barrier();
  if (isDue()) vkCmdFillBuffer(buffer_, filled, offset, bytes, value);
}

void Commands::updateBytes(const DeviceBuffer& buffer, const void* bytes, uint32_t size) {
  barrier();
  if (isDue()) vkCmdUpdateBuffer(buffer_, buffer.handle(), buffer.offset(), size, bytes);
}

void Commands::copy(const DeviceBuffer& from, VkBuffer to, VkDeviceSize offset, VkDeviceSize bytes,
                    VkDeviceSize first) {
  if (bytes == 0) return;
  barrier();
  const VkBufferCopy region{.srcOffset = from.offset() + first, .dstOffset = offset, .size = bytes};
  if (isDue()) vkCmdCopyBuffer(buffer_, from.handle(), to, 1, &region);
}

void Commands::copy(const DeviceBuffer& from, VkImage to, const VkExtent3D& extent) {
  barrier();
  const VkBufferImageCopy region{
      .bufferOffset = from.offset(),
      .imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
      .imageExtent = extent};
  if (!isDue()) return;
  vkCmdCopyBufferToImage(buffer_, from.handle(), to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

void Commands::lockstep(std::initializer_list<std::function<void()>> chains) {
  size_t steps = 1;  // Of the longest chain.
  for (size_t step = 1; step <= steps; ++step) {
    barrier();
    step_ = step;
    for (const std::function<void()>& chain : chains) {
      stepOfChain_ = 0;
      chain();
      steps = std::max(steps, stepOfChain_);
    }
    step_ = stepOfChain_ = 0;
  }
}

void Commands::barrier() {
  if (isConcurrent_) return;
  if (step_ > 0)
    ++stepOfChain_;
  else
    barrierBetween(buffer_, kWork, kWrites, kWorkAndArguments, kWrites | kReads);
}

}  // namespace raymap::vulkan
