#ifdef __cplusplus
#pragma once
#endif

// Lattice edges at which surface is missing, the same on every backend.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

RAYMAP_CONSTANT uint kCubesAround = 4;  // Number of cubes around a lattice edge.

// Lattice edge at which the sign changes although no triangle crosses it: surface is missing there.
struct MissingEdge {
  uint first;  // Sample at the edge's start; its end is the next sample along `axis`.
  uint axis;
  uint rimCubes;     // Bit c: triangles cross a sign change of cube c around the edge; see `cubeAround`.
  float winding[2];  // Winding numbers of the two samples.
};
RAYMAP_CHECK_SIZE(MissingEdge, 20);

RAYMAP_SHARED_END
