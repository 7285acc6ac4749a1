#ifndef RAYMAP_SHARED_CELL_LEVELS_H  // No pragma: GLSL also includes this more than once.
#define RAYMAP_SHARED_CELL_LEVELS_H

#include "base/shader_types.h"
#include "vulkan/stages/cell_lattice_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kMostLevels = 2;  // Maximum number of lattices that coverMesh returns.

// Results of the stages before `refine` for a lattice; there are no `begins` for `raster`.
struct CellLevelData {
  RAYMAP_ADDRESS(Uints) begins;  // See vulkan/stages/voxel_grid.h.
  RAYMAP_ADDRESS(Uints) entryCells;
  RAYMAP_ADDRESS(Uints) entryTriangles;
  RAYMAP_ADDRESS(Uints) count;
  RAYMAP_ADDRESS(Floats) squared;  // Before the transform.
  RAYMAP_ADDRESS(Uints) nearestCell;
  Lattice cells;
};
RAYMAP_CHECK_SIZE(CellLevelData, 88);

RAYMAP_SHARED_END

#endif
