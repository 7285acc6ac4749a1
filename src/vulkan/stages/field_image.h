#pragma once

#include <glm/vec3.hpp>

#include "vulkan/device/commands.h"
#include "vulkan/stages/field_image_push.h"

namespace raymap::vulkan {

/// Distances on their way into a 3D image of the caller's, single or half floats.
class FieldImageStage {
 public:
  explicit FieldImageStage(Device& device);

  /// Makes room; none for VK_FORMAT_UNDEFINED. Nothing recorded before may still have to run. Throws
  /// `Error(Usage)` for formats that it does not know.
  void reserve(const glm::ivec3& dims, VkFormat format);
  /// Where the distances have to be; 0 if there is no room.
  VkDeviceAddress distance() const { return distance_.bytes() > 0 ? distance_.address() : 0; }
  /// The image is left in `layout`, for all later commands to read.
  void record(Commands& commands, VkImage image, VkImageLayout layout);

 private:
  Kernel<HalfFloatsPush> toHalves_;
  DeviceBuffer distance_, halves_;
  glm::ivec3 dims_{0};
};

}  // namespace raymap::vulkan
