#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct VoxelGridPush {
  RAYMAP_ADDRESS(Uints) runTriangles;  // See vulkan/stages/cell_runs_push.h.
  RAYMAP_ADDRESS(Uints) runCells;
  RAYMAP_ADDRESS(Uints) runStarts;
  RAYMAP_ADDRESS(Uints) totals;
  RAYMAP_ADDRESS(Uints) cells;      // Cell of each entry.
  RAYMAP_ADDRESS(Uints) triangles;  // Triangle of each entry, which touches the cell.
  RAYMAP_ADDRESS(Uints) begins;     // First entry of each cell.
  RAYMAP_ADDRESS(Uints) count;      // Number of entries to be used.
  uint mostRows;
  uint mostEntries;
};
RAYMAP_CHECK_SIZE(VoxelGridPush, 72);

RAYMAP_SHARED_END
