#pragma once

#include "vulkan/self_test/probe.h"

namespace raymap::vulkan {

/// 3D image of a caller's, which copies can write and read and shaders can sample.
class ProbeImage {
 public:
  ProbeImage(const Device& device, VkFormat format, const glm::ivec3& dims)
      : extent_{uint32_t(dims.x), uint32_t(dims.y), uint32_t(dims.z)} {
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = VK_IMAGE_TYPE_3D,
                                 .format = format,
                                 .extent = extent_,
                                 .mipLevels = 1,
                                 .arrayLayers = 1,
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                          VK_IMAGE_USAGE_SAMPLED_BIT};
    create(image_, device.handle(), vkCreateImage, info, "making an image");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device.handle(), handle(), &needs);
    const VkMemoryAllocateInfo memory{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size,
        .memoryTypeIndex = device.memoryType(MemoryUse::Device, needs.memoryTypeBits)};
    create(memory_, device.handle(), vkAllocateMemory, memory, "allocating an image");
    check(vkBindImageMemory(device.handle(), handle(), memory_.get(), 0), "binding an image");
  }

  VkImage handle() const { return image_.get(); }

  /// Copies the texels of an image in VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL to a buffer.
  void recordCopy(const Commands& commands, const DeviceBuffer& texels) const {
    const VkBufferImageCopy region{
        .bufferOffset = texels.offset(),
        .imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
        .imageExtent = extent_};
    vkCmdCopyImageToBuffer(commands.handle(), handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, texels.handle(),
                           1, &region);
  }

 private:
  VkExtent3D extent_;
  Memory memory_;  // Destroyed after the image.
  Handle<VkImage, &vkDestroyImage> image_;
};

}  // namespace raymap::vulkan
