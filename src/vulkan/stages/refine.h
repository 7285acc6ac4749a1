#pragma once

#include "vulkan/stages/cell_levels.h"
#include "vulkan/stages/refine_push.h"

namespace raymap::vulkan {

/// The CPU's twin: the distance, in sample units, of every sample to the triangles of its nearest occupied
/// cell and, with `reach` 1, of that cell's neighbours, over all levels; and the closest of those triangles,
/// the lowest of several.
class RefineStage {
 public:
  struct Fields {
    VkDeviceAddress distance = 0;  ///< Of every sample;
    VkDeviceAddress triangle = 0;  ///< and the closest triangle's number, if not 0.
    VkDeviceAddress scratch = 0;   ///< Four bytes a sample, as DistanceTransform::scratch of the first level.
  };

  explicit RefineStage(Device& device);

  /// For grids of these dims, and levels whose stages have made their room. Nothing recorded before may still
  /// have to run.
  void reserve(const glm::ivec3& dims, std::span<const CellLevelData> levels);
  void record(Commands& commands, const DeviceMesh& mesh, const Fields& fields, int reach);

 private:
  glm::uvec3 dims_{0};
  Kernel<RefinePush> alone_, crowded_;
  CellLevels levels_;
  DispatchArguments arguments_;
  DeviceBuffer crowdedCount_;
};

}  // namespace raymap::vulkan
