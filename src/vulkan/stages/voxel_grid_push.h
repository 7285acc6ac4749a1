#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct VoxelGridPush {
  RAYMAP_ADDRESS(Uints) runTriangles;  // See shared/cell_runs.h.
  RAYMAP_ADDRESS(Uints) runCells;
  RAYMAP_ADDRESS(Uints) runStarts;
  RAYMAP_ADDRESS(Uints) totals;
  RAYMAP_ADDRESS(Uints) cells;      // Of each entry: its cell,
  RAYMAP_ADDRESS(Uints) triangles;  // and a triangle that touches it.
  RAYMAP_ADDRESS(Uints) begins;     // Of each cell: its first entry.
  RAYMAP_ADDRESS(Uints) count;      // How many entries there are to be used.
  uint mostRows;
  uint mostEntries;
};
RAYMAP_CHECK_SIZE(VoxelGridPush, 72);

RAYMAP_SHARED_END
