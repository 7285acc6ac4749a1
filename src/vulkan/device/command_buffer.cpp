#include "vulkan/device/command_buffer.h"

#include <algorithm>

#include "base/stopwatch.h"

namespace raymap::vulkan {

CommandBuffer::CommandBuffer(Device& device) : device_(&device), timer_(device) {
  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                     .queueFamilyIndex = device.queueFamily()};
  create(pool_, device.handle(), vkCreateCommandPool, pool, "making a command pool");
  const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  create(fence_, device.handle(), vkCreateFence, fence, "making a fence");
  for (Fence& each : partFences_) create(each, device.handle(), vkCreateFence, fence, "making a fence");
  const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = pool_.get(),
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = uint32_t(buffers_.size())};
  check(vkAllocateCommandBuffers(device.handle(), &info, buffers_.data()), "making command buffers");
}

CommandBuffer::~CommandBuffer() {
  for (size_t part = parts_ - std::min(parts_, kBuffers); part < parts_;
       ++part) {  // An error left them unused.
    const VkFence fence = partFences_[part % kBuffers].get();
    vkWaitForFences(device_->handle(), 1, &fence, VK_TRUE, UINT64_MAX);
  }
}

Commands CommandBuffer::begin() {
  waitForParts();
  parts_ = 0;
  check(vkResetCommandPool(device_->handle(), pool_.get(), 0), "resetting a command pool");
  startRecording();
  return {buffer(), device_->pipelineLayout(), &timer_};
}

void CommandBuffer::startRecording() {
  const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  check(vkBeginCommandBuffer(buffer(), &info), "recording commands");
}

size_t CommandBuffer::submitPart(Commands& commands) {
  submit(partFences_[parts_ % kBuffers].get());
  if (++parts_ >= kBuffers) waitForPart(parts_ - kBuffers);
  startRecording();
  commands.continueIn(buffer());
  return parts_ - 1;
}

void CommandBuffer::waitForPart(size_t part) {
  const bool isPending = part < parts_ && part + kBuffers >= parts_;
  if (isPending) waitFor(partFences_[part % kBuffers].get());
}

void CommandBuffer::waitForParts() {
  for (size_t part = parts_ - std::min(parts_, kBuffers); part < parts_; ++part) waitForPart(part);
}

void CommandBuffer::submit() {
  submit(fence_.get());
}

void CommandBuffer::submit(VkFence fence) {
  showAll(buffer());
  check(vkEndCommandBuffer(buffer()), "recording commands");
  const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = buffer()};
  const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                             .commandBufferInfoCount = 1,
                             .pCommandBufferInfos = &commands};
  check(vkResetFences(device_->handle(), 1, &fence), "resetting a fence");
  check(vkQueueSubmit2(device_->queue(), 1, &submit, fence), "submitting work to the device");
}

void CommandBuffer::wait() {
  waitFor(fence_.get());
}

/// Asks for a short time before it sleeps: to be woken takes longer than many steps of a card.
void CommandBuffer::waitFor(VkFence fence) {
  constexpr double kSpin = 0.2;  // Milliseconds.
  const Stopwatch stopwatch;
  while (vkGetFenceStatus(device_->handle(), fence) == VK_NOT_READY && stopwatch.milliseconds() < kSpin) {
  }
  check(vkWaitForFences(device_->handle(), 1, &fence, VK_TRUE, UINT64_MAX), "waiting for the device");
}

}  // namespace raymap::vulkan
