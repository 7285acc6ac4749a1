#pragma once

#include <glm/vec3.hpp>

#include "vulkan/device/commands.h"
#include "vulkan/stages/field_image_push.h"

namespace raymap::vulkan {

/// Writes distances to a caller's 3D image, as single or half floats.
class FieldImageStage {
 public:
  explicit FieldImageStage(Device& device);

  /// Reserves memory; none for VK_FORMAT_UNDEFINED. All previously recorded work must have completed. Throws
  /// `Error(Usage)` for other formats than R32_SFLOAT and R16_SFLOAT.
  void reserve(const glm::ivec3& dims, VkFormat format);
  /// Address that the distances must be written to; 0 without reserved memory.
  VkDeviceAddress distance() const { return distance_.bytes() > 0 ? distance_.address() : 0; }
  /// Buffer at this address.
  const DeviceBuffer& buffer() const { return distance_; }
  /// Leaves the image in `layout`, readable by all later commands.
  void record(Commands& commands, VkImage image, VkImageLayout layout);

 private:
  Kernel<HalfFloatsPush> toHalves_;
  DeviceBuffer distance_, halves_;
  glm::ivec3 dims_{0};
};

}  // namespace raymap::vulkan
