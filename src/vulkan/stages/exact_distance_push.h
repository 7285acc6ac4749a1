#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kListNodes = 222;  // A block's list has at most so many nodes.
RAYMAP_CONSTANT uint kListWords = 224;  // The number of nodes, the triangle closest to the centre, the nodes.
RAYMAP_CONSTANT uint kRestLeaves = 2048;  // What one pass over the rest looks at.

struct ExactDistancePush {
  RAYMAP_ADDRESS(Vec4s) frames;
  RAYMAP_ADDRESS(Vec4s) discs;
  RAYMAP_ADDRESS(Uints) parents;  // The lists of the blocks above; 0: there are none.
  RAYMAP_ADDRESS(Uints) lists;    // Of these blocks; unused for the smallest.
  RAYMAP_ADDRESS(Floats) distance;
  RAYMAP_ADDRESS(Uints) triangle;  // 0: not asked for.
  RAYMAP_ADDRESS(Uints)
  unfinished;  // How many small blocks were too much work, and which. 0: nothing is too much.
  uint dimX, dimY, dimZ;
  uint side;             // Samples along a block,
  uint blocksPerParent;  // and blocks along one of those above.
  uint firstLeaf;        // The number of the first leaf among all nodes,
  uint leafCount;
  uint restLeaf;    // and of that, among leaves, with which a pass over the rest begins.
  float band;       // In cells; 0: none.
  float tolerance;  // In cells: candidates that cannot win by more are dropped.
  uint
      isAddition;  // Only samples closer to these triangles than `distance` says are written, as kNoTriangle.
  uint unused;
};
RAYMAP_CHECK_SIZE(ExactDistancePush, 104);

RAYMAP_SHARED_END
