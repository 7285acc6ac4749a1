#ifdef __cplusplus
#pragma once
#endif

#include "shared/types.h"

RAYMAP_SHARED_BEGIN

RAYMAP_CONSTANT uint kDoubtsGroup = 128;    // Invocations of a group that looks at samples,
RAYMAP_CONSTANT uint kDoubtsSamples = 256;  // and those samples.
RAYMAP_CONSTANT uint kMomentVectors = 3;    // Of a node: the area vector, the symmetric second moment.

// The lattice is hardly ever farther from the winding number than this (docs/decisions/winding_dipoles.md).
// It knows least at the rims of the surface, at most so many cells away as the distance says.
RAYMAP_CONSTANT float kMostError = 0.15f;
RAYMAP_CONSTANT float kLeastError = 0.015f;
RAYMAP_CONSTANT float kMostErrorWithin = 2.0f;

// A group of triangles is distant from so many times its radius on, at first and when the number turns out so
// close to the threshold that the error, 0.002, 0.0002 and 0.00001 in the mean, could matter.
RAYMAP_CONSTANT uint kLooks = 3;
RAYMAP_CONSTANT float kDistant[kLooks] = {2.0f, 5.0f, 20.0f};
RAYMAP_CONSTANT float kClose[kLooks] = {0.03f, 0.004f, 0.0f};

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
