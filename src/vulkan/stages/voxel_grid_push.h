#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/stages/cell_lattice_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kFewRows = 8;    // Rows of a triangle that one invocation handles, at most.
RAYMAP_CONSTANT uint kPartRows = 32;  // Rows of a part of the other triangles.

// What the device counts: rows of cells in the triangles' bounds, and pairs of a cell and a triangle that
// touches it, in 64 bits each.
struct VoxelGridTotals {
  uint rows, rowsHigh;
  uint pairs, pairsHigh;
  uint parts;     // Parts of triangles with many rows.
  uint openRows;  // Rows for which floats do not suffice.
  uint entries;   // In the lists; 0 if a capacity did not suffice.
};
RAYMAP_CHECK_SIZE(VoxelGridTotals, 28);

struct VoxelGridPush {
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Uints) totals;  // VoxelGridTotals.
  RAYMAP_ADDRESS(Uint64s)
  rows;  // First row of each part, then the open rows: the triangle, and the row's number there.
  RAYMAP_ADDRESS(Uints) cells;     // Cell of each pair.
  RAYMAP_ADDRESS(Uints) touching;  // Triangle of each pair, which touches the cell.
  RAYMAP_ADDRESS(Uints) places;    // Number of each pair among those of its cell.
  RAYMAP_ADDRESS(Uints) begins;    // Number of pairs of each cell, less one. 0: no lists.
  Lattice lattice;
  uint triangleCount;
  uint mostRows;
  uint mostPairs;
  uint firstGroup;  // Number of groups before this dispatch.
};
RAYMAP_CHECK_SIZE(VoxelGridPush, 120);

struct VoxelGridListsPush {
  RAYMAP_ADDRESS(Uints) totals;
  RAYMAP_ADDRESS(Uints) cells;
  RAYMAP_ADDRESS(Uints) touching;
  RAYMAP_ADDRESS(Uints) places;
  RAYMAP_ADDRESS(Uints) begins;  // First entry of each cell.
  RAYMAP_ADDRESS(Uints) entryCells;
  RAYMAP_ADDRESS(Uints) entryTriangles;
  uint mostRows;
  uint mostPairs;
  uint firstGroup;
  uint unused;
};
RAYMAP_CHECK_SIZE(VoxelGridListsPush, 72);

RAYMAP_SHARED_END
