#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "method/winding_dipoles_accuracy.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kDoubtsGroup = 128;    // Invocations of a group that looks at samples,
RAYMAP_CONSTANT uint kDoubtsSamples = 256;  // and those samples.
RAYMAP_CONSTANT uint kMomentVectors = 3;    // Of a node: the area vector, the symmetric second moment.

struct WindingDipolesPush {
  RAYMAP_ADDRESS(Vec4s) frames;  // The surface tree.
  RAYMAP_ADDRESS(Vec4s) discs;
  RAYMAP_ADDRESS(Vec4s) moments;  // Of its nodes.
  RAYMAP_ADDRESS(Floats) distance;
  RAYMAP_ADDRESS(Floats) winding;
  RAYMAP_ADDRESS(Uints)
  doubts;  // Whether there is any sample that the lattice may have put on the wrong side.
  RAYMAP_ADDRESS(Uints) disagreeing;  // How many samples' rays disagree.
  RAYMAP_ADDRESS(Floats) points;      // Three coordinates each; their numbers then go to `winding`.
  uint gridX, gridY, gridZ;           // Samples of the grid.
  uint triangleCount;
  uint firstLeaf;   // Number of the first leaf among all nodes.
  uint levelStart;  // The first node of the level that is written,
  uint levelCount;  // and how many it has.
  uint isLeafLevel;
  float threshold;
  uint mostTurns;  // Of a loop over nodes of the tree.
  uint pointCount;
  uint unused;
};
RAYMAP_CHECK_SIZE(WindingDipolesPush, 112);

RAYMAP_SHARED_END
