#include "vulkan/device/command_buffer.h"

#include <utility>

namespace raymap::vulkan {

CommandBuffer::CommandBuffer(Device& device) : device_(&device), timer_(device) {
  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                     .queueFamilyIndex = device.queueFamily()};
  create(pool_, device.handle(), vkCreateCommandPool, pool, "making a command pool");
  const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  for (Fence* each : {&fence_, &partFence_})
    create(*each, device.handle(), vkCreateFence, fence, "making a fence");
  const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = pool_.get(),
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = uint32_t(buffers_.size())};
  check(vkAllocateCommandBuffers(device.handle(), &info, buffers_.data()), "making command buffers");
}

CommandBuffer::~CommandBuffer() {
  if (!isPartSubmitted_) return;
  const VkFence fence = partFence_.get();  // An error left the part unused.
  vkWaitForFences(device_->handle(), 1, &fence, VK_TRUE, UINT64_MAX);
}

Commands CommandBuffer::begin() {
  waitForPart();
  check(vkResetCommandPool(device_->handle(), pool_.get(), 0), "resetting a command pool");
  startRecording();
  return {buffers_[0], device_->pipelineLayout(), &timer_};
}

void CommandBuffer::startRecording() {
  const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  check(vkBeginCommandBuffer(buffers_[0], &info), "recording commands");
}

void CommandBuffer::submitPart(Commands& commands) {
  waitForPart();
  submit(partFence_.get());
  isPartSubmitted_ = true;
  std::swap(buffers_[0], buffers_[1]);
  startRecording();
  commands.continueIn(buffers_[0]);
}

void CommandBuffer::waitForPart() {
  if (!std::exchange(isPartSubmitted_, false)) return;
  const VkFence fence = partFence_.get();
  check(vkWaitForFences(device_->handle(), 1, &fence, VK_TRUE, UINT64_MAX), "waiting for the device");
}

void CommandBuffer::submit() {
  submit(fence_.get());
}

void CommandBuffer::submit(VkFence fence) {
  showAll(buffers_[0]);
  check(vkEndCommandBuffer(buffers_[0]), "recording commands");
  const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = buffers_[0]};
  const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &commands};
  check(vkResetFences(device_->handle(), 1, &fence), "resetting a fence");
  check(vkQueueSubmit2(device_->queue(), 1, &submit, fence), "submitting work to the device");
}

void CommandBuffer::wait() {
  const VkFence fence = fence_.get();
  check(vkWaitForFences(device_->handle(), 1, &fence, VK_TRUE, UINT64_MAX), "waiting for the device");
}

}  // namespace raymap::vulkan
