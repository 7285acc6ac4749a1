#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/stages/cell_lattice_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct RasterDistancePush {
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Uints) runTriangles;  // See vulkan/stages/cell_runs_push.h.
  RAYMAP_ADDRESS(Uints) runCells;
  RAYMAP_ADDRESS(Uints) runStarts;
  RAYMAP_ADDRESS(Uints) totals;
  RAYMAP_ADDRESS(Uints) squared;  // Per cell; bits of floats, which keep the floats' order from 0 on.
  Lattice cells;
  float perCell2;  // Square cells per square sample.
  uint mostRows;
};
RAYMAP_CHECK_SIZE(RasterDistancePush, 104);

RAYMAP_SHARED_END
