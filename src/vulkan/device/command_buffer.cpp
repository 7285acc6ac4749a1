#include "vulkan/device/command_buffer.h"

namespace raymap::vulkan {

CommandBuffer::CommandBuffer(Device& device) : device_(&device), timer_(device) {
  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .queueFamilyIndex = device.queueFamily()};
  create(pool_, device.handle(), vkCreateCommandPool, pool, "making a command pool");
  const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  create(fence_, device.handle(), vkCreateFence, fence, "making a fence");
  const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = pool_.get(),
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = 1};
  check(vkAllocateCommandBuffers(device.handle(), &info, &buffer_), "making a command buffer");
}

Commands CommandBuffer::begin() {
  check(vkResetCommandPool(device_->handle(), pool_.get(), 0), "resetting a command pool");
  const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  check(vkBeginCommandBuffer(buffer_, &info), "recording commands");
  return {buffer_, device_->pipelineLayout(), &timer_};
}

void CommandBuffer::submit() {
  showAll(buffer_);
  check(vkEndCommandBuffer(buffer_), "recording commands");
  const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = buffer_};
  const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &commands};
  const VkFence fence = fence_.get();
  check(vkResetFences(device_->handle(), 1, &fence), "resetting a fence");
  check(vkQueueSubmit2(device_->queue(), 1, &submit, fence), "submitting work to the device");
}

void CommandBuffer::wait() {
  const VkFence fence = fence_.get();
  check(vkWaitForFences(device_->handle(), 1, &fence, VK_TRUE, UINT64_MAX), "waiting for the device");
}

}  // namespace raymap::vulkan
