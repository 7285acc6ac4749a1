#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/stages/cell_lattice_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct CellDistancePush {
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Uints) entryCells;  // See vulkan/voxel_grid.h.
  RAYMAP_ADDRESS(Uints) entryTriangles;
  RAYMAP_ADDRESS(Uints) count;    // Of entries.
  RAYMAP_ADDRESS(Uints) squared;  // Of each cell; the bits of floats, which order as they do from 0 on.
  Lattice cells;
  float perCell2;  // Square cells in a square sample.
  uint unused;
};
RAYMAP_CHECK_SIZE(CellDistancePush, 104);

RAYMAP_SHARED_END
