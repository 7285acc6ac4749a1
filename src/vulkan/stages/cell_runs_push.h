#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/stages/cell_lattice_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRunsGroup = 256;  // Runs that a group expands.

// How many rows of cells the triangles' bounds touch, and how many cells the triangles do; 64 bits each.
struct CellRunsTotals {
  uint rows, rowsHigh;
  uint entries, entriesHigh;
};
RAYMAP_CHECK_SIZE(CellRunsTotals, 16);

// Of each row of cells that a triangle's bounds touch: the run of cells in it that the triangle touches.
struct CellRunsPush {
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Uints) rowStarts;  // Of each triangle: how many rows it has, then which is its first.
  RAYMAP_ADDRESS(Uints) runTriangles;
  RAYMAP_ADDRESS(Uints) runCells;  // The first.
  RAYMAP_ADDRESS(Uints) runSizes;
  RAYMAP_ADDRESS(Uints) totals;  // CellRunsTotals
  Lattice cells;
  uint triangleCount;
  uint mostRows;
};
RAYMAP_CHECK_SIZE(CellRunsPush, 112);

RAYMAP_SHARED_END
