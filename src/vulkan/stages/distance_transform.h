#pragma once

#include <glm/glm.hpp>

#include "vulkan/device/commands.h"
#include "vulkan/stages/distance_transform_push.h"

namespace raymap::vulkan {

/// The CPU's twin, but that the values stay as they are: the transform's value of cell p with the nearest
/// cell q is ((dx^2 + f(q)) + dy^2) + dz^2 in single precision.
class DistanceTransformStage {
 public:
  explicit DistanceTransformStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Makes room for grids of these dims. Nothing recorded before may still have to run. Throws
  /// `Error(Unsupported)` where a line of cells does not fit into the memory that a work group shares.
  void reserve(const glm::ivec3& dims);
  /// For the grid of the last `reserve`: `squared` holds the values f(q) that `cell_distance` leaves.
  void record(Commands& commands, VkDeviceAddress squared);

  /// The index of every cell's nearest one, or `kNoCell`.
  VkDeviceAddress nearestCell() const { return nearest_.address(); }
  const DeviceBuffer& nearestCells() const { return nearest_; }
  /// As large, and free for others after the transform.
  VkDeviceAddress scratch() const { return scratch_.address(); }

 private:
  using Push = DistanceTransformPush;
  void pass(Commands& commands, Kernel<Push>& kernel, int axis, VkDeviceAddress squared, VkDeviceAddress from,
            VkDeviceAddress to);

  glm::ivec3 dims_{0};
  uint32_t groupSize_;
  Kernel<Push> alongX_, alongY_, alongZ_;
  DeviceBuffer nearest_, scratch_;
};

}  // namespace raymap::vulkan
