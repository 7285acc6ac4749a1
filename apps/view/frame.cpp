#include "frame.h"

#include "swapchain.h"

namespace raymap::view {

Frame::Frame(const Gpu& gpu) : gpu_(gpu), isFree_(makeSemaphore(gpu)) {
  const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                         .queueFamilyIndex = gpu.handles().queueFamily};
  VkCommandPool pool = VK_NULL_HANDLE;
  check(vkCreateCommandPool(gpu.device(), &poolInfo, nullptr, &pool), "making a command pool");
  pool_ = own(gpu.device(), pool, vkDestroyCommandPool);
  const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = pool,
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = 1};
  check(vkAllocateCommandBuffers(gpu.device(), &info, &commands_), "making a command buffer");
  const VkFenceCreateInfo fenceInfo{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO,
                                    .flags = VK_FENCE_CREATE_SIGNALED_BIT};
  VkFence fence = VK_NULL_HANDLE;
  check(vkCreateFence(gpu.device(), &fenceInfo, nullptr, &fence), "making a fence");
  isDone_ = own(gpu.device(), fence, vkDestroyFence);
  const VkQueryPoolCreateInfo stampInfo{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                        .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                        .queryCount = kMaxStamps};
  VkQueryPool stamps = VK_NULL_HANDLE;
  check(vkCreateQueryPool(gpu.device(), &stampInfo, nullptr, &stamps), "making timestamps");
  stamps_ = own(gpu.device(), stamps, vkDestroyQueryPool);
}

void Frame::begin() {
  const VkFence fence = isDone_.get();
  check(vkWaitForFences(gpu_.device(), 1, &fence, VK_TRUE, UINT64_MAX), "waiting for the device");
  readTimes();
  kept_.clear();
  check(vkResetCommandPool(gpu_.device(), pool_.get(), 0), "resetting a command pool");
  const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  check(vkBeginCommandBuffer(commands_, &info), "recording");
  vkCmdResetQueryPool(commands_, stamps_.get(), 0, kMaxStamps);
  stages_.clear();
  stamp("start");
}

void Frame::submit(VkSemaphore isDrawn) {
  check(vkEndCommandBuffer(commands_), "recording");
  const VkFence fence = isDone_.get();
  check(vkResetFences(gpu_.device(), 1, &fence), "resetting a fence");
  const VkSemaphore isFree = isFree_.get();
  // The window's image is first written by a copy.
  const VkPipelineStageFlags first = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
  const VkSubmitInfo info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                          .waitSemaphoreCount = 1,
                          .pWaitSemaphores = &isFree,
                          .pWaitDstStageMask = &first,
                          .commandBufferCount = 1,
                          .pCommandBuffers = &commands_,
                          .signalSemaphoreCount = 1,
                          .pSignalSemaphores = &isDrawn};
  check(vkQueueSubmit(gpu_.handles().queue, 1, &info, fence), "giving work to the device");
}

void Frame::stamp(const char* stage) {
  if (gpu_.nanosecondsPerTick() == 0.0 || stages_.size() == kMaxStamps) return;
  vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, stamps_.get(),
                       uint32_t(stages_.size()));
  stages_.push_back(stage);
}

void Frame::readTimes() {
  times_.clear();
  if (stages_.size() < 2) return;
  std::vector<uint64_t> ticks(stages_.size());
  const VkResult result = vkGetQueryPoolResults(gpu_.device(), stamps_.get(), 0, uint32_t(ticks.size()),
                                                ticks.size() * sizeof(uint64_t), ticks.data(),
                                                sizeof(uint64_t), VK_QUERY_RESULT_64_BIT);
  if (result == VK_NOT_READY) return;
  check(result, "reading timestamps");
  for (size_t i = 1; i < ticks.size(); ++i)
    times_.push_back({stages_[i], 1e-6 * gpu_.nanosecondsPerTick() * double(ticks[i] - ticks[i - 1])});
}

void Frame::upload(std::span<const std::byte> bytes, const Buffer& to) {
  if (bytes.empty()) return;
  barrier(commands_);
  if (constexpr size_t kMostInCommands = 65536; bytes.size() <= kMostInCommands) {
    vkCmdUpdateBuffer(commands_, to.handle.get(), 0, bytes.size(), bytes.data());  // Allocates nothing.
  } else {
    const Buffer& staging = keep(gpu_.stage(bytes));
    const VkBufferCopy all{.size = bytes.size()};
    vkCmdCopyBuffer(commands_, staging.handle.get(), to.handle.get(), 1, &all);
  }
  barrier(commands_);
}

}  // namespace raymap::view
