#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "method/winding_dipoles_shared.h"
#include "method/winding_doubts_shared.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kDoubtsEach = 8;  // Samples that an invocation looks at: a card takes time to start one.
RAYMAP_CONSTANT uint kMomentVectors = 3;    // Per node: the area vector, the symmetric second moment.
RAYMAP_CONSTANT uint kMostTreeLevels = 10;  // Enough for 2^29 triangles.
// The list of doubtful samples has capacity for one of this many samples of the grid.
RAYMAP_CONSTANT uint kSamplesPerListed = 8;

struct WindingDipolesPush {
  RAYMAP_ADDRESS(Vec4s) frames;  // The surface tree.
  RAYMAP_ADDRESS(Vec4s) discs;
  RAYMAP_ADDRESS(Vec4s) moments;  // Moments of its nodes.
  RAYMAP_ADDRESS(Floats) distance;
  RAYMAP_ADDRESS(Floats) winding;
  RAYMAP_ADDRESS(Uints)
  doubts;                             // Number of samples that may be on the wrong side, then their list.
  RAYMAP_ADDRESS(Uints) disagreeing;  // Number of samples whose rays disagree.
  RAYMAP_ADDRESS(Floats) points;      // Three coordinates each; their numbers then go to `winding`.
  RAYMAP_ADDRESS(Floats) change;      // The largest change of the numbers (winding_doubts.comp).
  uvec3 dims;                         // Samples of the grid.
  uint triangleCount;
  uint firstLeaf;   // Index of the first leaf among all nodes.
  uint levelStart;  // First node of the level to be written.
  uint levelCount;  // Number of its nodes.
  float threshold;
  uint mostTurns;  // Maximum number of turns of a group (winding_number.glsl).
  uint pointCount;
  uint mostListed;  // Capacity of the list of doubtful samples.
  uint firstGroup;  // Number of groups before this dispatch.
  uint looks;       // At most.
  uint rimsDecide;  // Whether rims decide where the last look is not sure.
};
RAYMAP_CHECK_SIZE(WindingDipolesPush, 128);

RAYMAP_SHARED_END
