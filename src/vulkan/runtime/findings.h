#pragma once

#include "vulkan/device/features.h"
#include "vulkan/stages/cell_levels_push.h"
#include "vulkan/stages/cell_mesh_push.h"
#include "vulkan/stages/crossings_push.h"
#include "vulkan/stages/voxel_grid_push.h"

namespace raymap::vulkan {

/// Results of the stages for the host. Stages that did not run leave their part unchanged.
struct Findings {
  CellMeshStatus mesh;
  CrossingsStatus crossings;
  VoxelGridTotals lists[kMostLevels];
  uint32_t doubtful;  ///< Samples whose rays disagree.
};

}  // namespace raymap::vulkan
