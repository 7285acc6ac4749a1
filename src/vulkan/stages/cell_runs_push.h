#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/stages/cell_lattice_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRunsGroup = 256;  // Runs that a group expands.

// Number of cell rows in the triangles' bounds, and number of cells that the triangles touch; 64 bits each.
struct CellRunsTotals {
  uint rows, rowsHigh;
  uint entries, entriesHigh;
};
RAYMAP_CHECK_SIZE(CellRunsTotals, 16);

// For each row of cells in a triangle's bounds: the run of cells that the triangle touches.
struct CellRunsPush {
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Uints) rowStarts;  // Per triangle: the number of its rows, then its first row.
  RAYMAP_ADDRESS(Uints) runTriangles;
  RAYMAP_ADDRESS(Uints) runCells;  // First cell of each run.
  RAYMAP_ADDRESS(Uints) runSizes;
  RAYMAP_ADDRESS(Uints) totals;   // CellRunsTotals.
  RAYMAP_ADDRESS(Uints) unknown;  // Rows for which floats do not suffice.
  RAYMAP_ADDRESS(Uints) unknownCount;
  Lattice cells;
  uint triangleCount;
  uint mostRows;
};
RAYMAP_CHECK_SIZE(CellRunsPush, 120);

RAYMAP_SHARED_END
