// Ours: the paper's §4 samples fields as textures.

#include "vulkan/stages/field_image.h"

#include <raymap/error.h>

#include "shaders/field_image_halves_spv.h"

namespace raymap::vulkan {

namespace {

/// Changes the layout after earlier transfers, and before later accesses.
void change(VkCommandBuffer buffer, VkImage image, VkImageLayout before, VkImageLayout after,
            VkAccessFlags2 written, VkPipelineStageFlags2 later, VkAccessFlags2 accesses) {
  const VkImageMemoryBarrier2 barrier{
      .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
      .srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
      .srcAccessMask = written,
      .dstStageMask = later,
      .dstAccessMask = accesses,
      .oldLayout = before,
      .newLayout = after,
      .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
      .image = image,
      .subresourceRange = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .levelCount = 1, .layerCount = 1}};
  const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                              .imageMemoryBarrierCount = 1,
                              .pImageMemoryBarriers = &barrier};
  vkCmdPipelineBarrier2(buffer, &info);
}

}  // namespace

FieldImageStage::FieldImageStage(Device& device)
    : toHalves_(device, shaders::kFieldImageHalves, 128),
      distance_(device, "distance for an image"),
      halves_(device, "distance in half floats") {}

void FieldImageStage::reserve(const glm::ivec3& dims, VkFormat format) {
  if (format != VK_FORMAT_UNDEFINED && format != VK_FORMAT_R32_SFLOAT && format != VK_FORMAT_R16_SFLOAT)
    throw Error(ErrorCode::Usage, "images of VkFormat " + std::to_string(format) +
                                      " are not written; use VK_FORMAT_R32_SFLOAT or VK_FORMAT_R16_SFLOAT");
  const uint64_t count = uint64_t(dims.x) * uint64_t(dims.y) * uint64_t(dims.z);
  distance_.resize<float>(format == VK_FORMAT_UNDEFINED ? 0 : count);
  halves_.resize<uint32_t>(format == VK_FORMAT_R16_SFLOAT ? (count + 1) / 2 : 0);
  dims_ = dims;
  if (halves_.bytes() > 0) toHalves_.handle();  // Makes the kernel, because `record` only records.
}

void FieldImageStage::record(Commands& commands, VkImage image, VkImageLayout layout) {
  const DeviceBuffer& texels = halves_.bytes() > 0 ? halves_ : distance_;
  if (halves_.bytes() > 0) {
    const auto count = static_cast<uint32_t>(distance_.bytes() / sizeof(float));
    commands.dispatch(toHalves_, {.values = distance_.address(), .halves = halves_.address(), .count = count},
                      (uint64_t{count} + 1) / 2);
  }
  change(commands.handle(), image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0,
         VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  commands.copy(texels, image, VkExtent3D{uint32_t(dims_.x), uint32_t(dims_.y), uint32_t(dims_.z)});
  change(commands.handle(), image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, layout,
         VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
         VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

}  // namespace raymap::vulkan
