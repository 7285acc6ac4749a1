#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "method/winding_dipoles_accuracy.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kDoubtsGroup = 128;    // Invocations of a group that tests samples.
RAYMAP_CONSTANT uint kDoubtsSamples = 256;  // Samples of such a group.
RAYMAP_CONSTANT uint kMomentVectors = 3;    // Per node: the area vector, the symmetric second moment.

struct WindingDipolesPush {
  RAYMAP_ADDRESS(Vec4s) frames;  // The surface tree.
  RAYMAP_ADDRESS(Vec4s) discs;
  RAYMAP_ADDRESS(Vec4s) moments;  // Moments of its nodes.
  RAYMAP_ADDRESS(Floats) distance;
  RAYMAP_ADDRESS(Floats) winding;
  RAYMAP_ADDRESS(Uints)
  doubts;                             // Nonzero if the lattice may have put a sample on the wrong side.
  RAYMAP_ADDRESS(Uints) disagreeing;  // Number of samples whose rays disagree.
  RAYMAP_ADDRESS(Floats) points;      // Three coordinates each; their numbers then go to `winding`.
  uint gridX, gridY, gridZ;           // Samples of the grid.
  uint triangleCount;
  uint firstLeaf;   // Index of the first leaf among all nodes.
  uint levelStart;  // First node of the level to be written.
  uint levelCount;  // Number of its nodes.
  uint isLeafLevel;
  float threshold;
  uint mostTurns;  // Maximum number of iterations of a loop over nodes.
  uint pointCount;
  uint unused;
};
RAYMAP_CHECK_SIZE(WindingDipolesPush, 112);

RAYMAP_SHARED_END
