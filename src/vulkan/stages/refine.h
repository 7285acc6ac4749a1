#pragma once

#include "vulkan/stages/cell_levels.h"
#include "vulkan/stages/refine_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/cells/refine.h. Computes every sample's distance, in sample units, to the triangles of its
/// nearest occupied cell, over all levels. With `reach` 1 that cell's neighbours are used, too. Also finds
/// the closest of these triangles; among several, the lowest index.
class RefineStage {
 public:
  struct Fields {
    VkDeviceAddress distance = 0;  ///< One value per sample.
    VkDeviceAddress triangle = 0;  ///< Index of the closest triangle per sample; 0: not requested.
    VkDeviceAddress scratch = 0;   ///< Four bytes per sample, such as DistanceTransformStage::scratch of the
                                   ///< first level.
  };

  explicit RefineStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Prepares for meshes of at most this many triangles, grids of these dims and these levels, whose stages
  /// must have reserved their memory. All previously recorded work must have completed.
  void reserve(const glm::ivec3& dims, uint32_t triangles, std::span<const CellLevelData> levels);
  void record(Commands& commands, const DeviceMesh& mesh, const Fields& fields, int reach);

 private:
  glm::uvec3 dims_{0};
  Kernel<RefinePush> findFrames_;
  LatticeKernel<RefinePush> alone_, crowded_;
  CellLevels levels_;
  DispatchArguments arguments_;
  DeviceBuffer frames_, crowdedCount_;
};

}  // namespace raymap::vulkan
