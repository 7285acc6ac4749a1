#pragma once

#include "vulkan/stages/cell_levels.h"
#include "vulkan/stages/raster_distance_push.h"

namespace raymap::vulkan {

/// GPU twin of `sampleRasterDistance` in cpu/cells/raster_distance.h (the last paragraph of §3.3). The cells'
/// distances come from `CellDistanceStage`, of a voxel grid without lists. Computes the distance, in sample
/// units, of every sample after the distance transform of each level.
class RasterDistanceStage {
 public:
  explicit RasterDistanceStage(Device& device);

  /// Prepares for grids of these dims and these levels, whose stages must have reserved their memory. All
  /// previously recorded work must have completed.
  void reserve(const glm::ivec3& dims, std::span<const CellLevelData> levels);
  void record(Commands& commands, VkDeviceAddress distance);

 private:
  glm::uvec3 dims_{0};
  LatticeKernel<RasterDistancePush> kernel_;
  CellLevels levels_;
};

}  // namespace raymap::vulkan
