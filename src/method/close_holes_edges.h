#ifdef __cplusplus
#pragma once
#endif

// Where surface is missing, as both backends find it.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

RAYMAP_CONSTANT uint kCubesAround = 4;  // An edge of the lattice.

// A lattice edge at which the sign changes although no triangle crosses it: surface is missing there.
struct MissingEdge {
  uint first;  // The sample that it leads from, to the next one along `axis`.
  uint axis;
  uint rimCubes;     // Bit c: triangles do cross a sign change of cube c around it; see `cubeAround`.
  float winding[2];  // Of the two samples.
};
RAYMAP_CHECK_SIZE(MissingEdge, 20);

RAYMAP_SHARED_END
