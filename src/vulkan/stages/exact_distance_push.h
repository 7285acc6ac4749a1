#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kBlockSide = 4;              // Samples along the smallest blocks.
RAYMAP_CONSTANT uint kBlockSamples = 64;          // Samples of such a block.
RAYMAP_CONSTANT uint kListNodes = 222;            // Maximum number of nodes in a block's list.
RAYMAP_CONSTANT uint kListWords = 224;            // Number of nodes, triangle closest to the centre, nodes.
RAYMAP_CONSTANT uint kNoneClosest = 0xffffffffu;  // The public kNoTriangle.
RAYMAP_CONSTANT uint kRestLeaves = 2048;          // Leaves per pass over the samples that are left.

struct ExactDistancePush {
  RAYMAP_ADDRESS(Vec4s) frames;
  RAYMAP_ADDRESS(Vec4s) discs;
  RAYMAP_ADDRESS(Uints) parents;  // Lists of the blocks above; 0: none.
  RAYMAP_ADDRESS(Uints) lists;    // Lists of these blocks; unused for the smallest.
  RAYMAP_ADDRESS(Floats) distance;
  RAYMAP_ADDRESS(Uints) triangle;  // 0: not requested.
  // Small blocks with too much work: the number of their samples, then their indices; 0: all blocks.
  RAYMAP_ADDRESS(Uints) heavy;
  RAYMAP_ADDRESS(Uints) left;  // Samples with too much work: their number, then their indices.
  uvec3 dims;
  uint side;             // Samples along a block.
  uint blocksPerParent;  // Blocks along one of the blocks above.
  uint firstLeaf;        // Index of the first leaf among all nodes.
  uint leafCount;
  uint restLeaf;    // First leaf of a pass over the samples that are left, as an index among leaves.
  float band;       // In cells; 0: none.
  float tolerance;  // In cells: candidates that can win by at most this are dropped.
  uint isAddition;  // Writes only samples closer to these triangles than `distance`, as kNoneClosest.
  uint mostWork;    // Most loop iterations of a subgroup, about; 0: any number.
  uint firstGroup;  // Number of groups before this dispatch.
  uint unused;
};
RAYMAP_CHECK_SIZE(ExactDistancePush, 120);

RAYMAP_SHARED_END
