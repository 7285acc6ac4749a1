#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/stages/cell_lattice_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct CellDistancePush {
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Uints) entryCells;  // See vulkan/stages/voxel_grid.h.
  RAYMAP_ADDRESS(Uints) entryTriangles;
  RAYMAP_ADDRESS(Uints) count;    // Number of entries.
  RAYMAP_ADDRESS(Uints) squared;  // Per cell; bits of floats, which keep the floats' order from 0 on.
  Lattice cells;
  float perCell2;  // Square cells per square sample.
  uint mostEntries;
  uint firstGroup;  // Number of groups before this dispatch.
  uint unused;
};
RAYMAP_CHECK_SIZE(CellDistancePush, 104);

RAYMAP_SHARED_END
