#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/stages/cell_lattice_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kFewRows = 8;    // Rows of a triangle that one invocation handles, at most.
RAYMAP_CONSTANT uint kPartRows = 32;  // Rows of a part of the other triangles.
RAYMAP_CONSTANT uint kOpenRowsGroup =
    128;                                  // Invocations of a group for rows for which floats do not suffice.
RAYMAP_CONSTANT uint kOpenRowLanes = 16;  // Invocations that share such a row.

// Numbers that the device counts.
struct VoxelGridTotals {
  uint rows, rowsHigh;    // Rows of cells in the triangles' bounds.
  uint pairs, pairsHigh;  // Pairs of a cell and a triangle that touches it.
  uint parts;             // Parts of triangles with many rows.
  uint openRows;          // Rows for which floats do not suffice.
  uint entries;           // In the lists; 0 if a capacity did not suffice.
};
RAYMAP_CHECK_SIZE(VoxelGridTotals, 28);

// Words of the totals; the upper half of a number of 64 bits is the next one.
RAYMAP_CONSTANT uint kRowsWord = 0;
RAYMAP_CONSTANT uint kPairsWord = 2;
RAYMAP_CONSTANT uint kPartsWord = 4;
RAYMAP_CONSTANT uint kOpenRowsWord = 5;
RAYMAP_CONSTANT uint kEntriesWord = 6;

// Returns the most parts that so many rows make: a triangle of n > kFewRows rows has at most n / kFewRows.
RAYMAP_FUNCTION uint mostParts(uint mostRows) {
  return mostRows / kFewRows;
}

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
