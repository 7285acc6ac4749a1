#pragma once

#include <glm/glm.hpp>

#include "vulkan/device/commands.h"
#include "vulkan/stages/distance_transform_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/cells/distance_transform.h, but leaves the values unchanged. The transform's value of cell
/// p with the nearest cell q is ((dx^2 + f(q)) + dy^2) + dz^2 in single precision.
class DistanceTransformStage {
 public:
  explicit DistanceTransformStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for grids of these dims. All previously recorded work must have completed. Throws
  /// `Error(Unsupported)` if a line of cells does not fit into the memory that a work group shares.
  void reserve(const glm::ivec3& dims);
  /// Works on the grid of the last `reserve`. `squared` holds the values f(q) of the stage `cell_distance`
  /// or `raster_distance`, which are at most 3/4.
  void record(Commands& commands, VkDeviceAddress squared);

  /// Address of the index of every cell's nearest cell, or `kNoCell`.
  VkDeviceAddress nearestCell() const { return nearest_.address(); }
  const DeviceBuffer& nearestCells() const { return nearest_; }
  /// Address of a buffer of the same size, free for other stages after the transform.
  VkDeviceAddress scratch() const { return scratch_.address(); }

 private:
  using Push = DistanceTransformPush;
  void pass(Commands& commands, Kernel<Push>& kernel, int axis, VkDeviceAddress squared, VkDeviceAddress from,
            VkDeviceAddress to);

  Push pushOf(VkDeviceAddress squared, VkDeviceAddress from, VkDeviceAddress to) const;

  glm::ivec3 dims_{0};
  uint32_t cells_;         // Most cells in a group's lines.
  uint32_t subgroupSize_;  // The largest that a subgroup may be.
  Kernel<Push> alongX_, alongY_, alongZ_;
  DeviceBuffer nearest_, scratch_;
};

}  // namespace raymap::vulkan
