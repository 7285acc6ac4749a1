#include "vulkan/device/commands.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstddef>

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
    const uint64_t rows = std::min(mostRows, y - row);
    if (makeRoom(x * rows * kernel.groupSize() * weight) || row == 0) {
      barrier();
      bind(kernel, push, pushBytes);
    }
    add([=](VkCommandBuffer buffer) {
      vkCmdDispatchBase(buffer, 0, static_cast<uint32_t>(row), 0, static_cast<uint32_t>(x),
                        static_cast<uint32_t>(rows), 1);
    });
  }
}

/// Returns whether recording continues in a new command buffer.
bool Commands::makeRoom(uint64_t invocations) {
  recorded_ += invocations;
  if (!listener_ || isConcurrent_ || isLockstep_ || recorded_ <= kMostSubmitted) return false;
  listener_->onMuchWork();
  recorded_ = invocations;
  return true;
}

void Commands::dispatchIndirectBytes(ComputePipeline& kernel, const void* push, uint32_t pushBytes,
                                     const DeviceBuffer& arguments, VkDeviceSize offset) {
  bind(kernel, push, pushBytes);
  add([from = arguments.handle(), first = arguments.offset() + offset](VkCommandBuffer buffer) {
    vkCmdDispatchIndirect(buffer, from, first);
  });
}

void Commands::bind(ComputePipeline& kernel, const void* push, uint32_t pushBytes) {
  const auto* first = static_cast<const std::byte*>(push);
  add([pipeline = kernel.handle(), layout = layout_,
       bytes = std::vector<std::byte>(first, first + pushBytes)](VkCommandBuffer buffer) {
    vkCmdBindPipeline(buffer, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    vkCmdPushConstants(buffer, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, static_cast<uint32_t>(bytes.size()),
                       bytes.data());
  });
}

void Commands::fill(VkBuffer filled, VkDeviceSize offset, VkDeviceSize bytes, uint32_t value) {
  if (bytes == 0) return;
  barrier();
  add([=](VkCommandBuffer buffer) { vkCmdFillBuffer(buffer, filled, offset, bytes, value); });
}

void Commands::updateBytes(const DeviceBuffer& buffer, const void* bytes, uint32_t size) {
  barrier();
  const auto* first = static_cast<const std::byte*>(bytes);
  add([to = buffer.handle(), offset = buffer.offset(),
       values = std::vector<std::byte>(first, first + size)](VkCommandBuffer commands) {
    vkCmdUpdateBuffer(commands, to, offset, values.size(), values.data());
  });
}

void Commands::copy(const DeviceBuffer& from, VkBuffer to, VkDeviceSize offset, VkDeviceSize bytes,
                    VkDeviceSize first) {
  if (bytes == 0) return;
  barrier();
  const VkBufferCopy region{.srcOffset = from.offset() + first, .dstOffset = offset, .size = bytes};
  add([to, region, source = from.handle()](VkCommandBuffer buffer) {
    vkCmdCopyBuffer(buffer, source, to, 1, &region);
  });
}

void Commands::copy(const DeviceBuffer& from, VkImage to, const VkExtent3D& extent) {
  barrier();
  const VkBufferImageCopy region{
      .bufferOffset = from.offset(),
      .imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
      .imageExtent = extent};
  add([to, region, source = from.handle()](VkCommandBuffer buffer) {
    vkCmdCopyBufferToImage(buffer, source, to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
  });
}

void Commands::lockstep(std::initializer_list<std::function<void()>> chains) {
  isLockstep_ = true;
  for (const std::function<void()>& chain : chains) {
    stepsOfChain_ = 0;
    chain();
  }
  isLockstep_ = false;
  for (const std::vector<Deferred>& step : std::exchange(steps_, {})) {
    barrier();
    for (const Deferred& command : step) command(buffer_);
  }
}

void Commands::barrier() {
  if (isConcurrent_) return;
  if (!isLockstep_)
    barrierBetween(buffer_, kWork, kWrites, kWorkAndArguments, kWrites | kReads);
  else if (++stepsOfChain_ > steps_.size())
    steps_.emplace_back();
}

}  // namespace raymap::vulkan
