#ifdef __cplusplus
#pragma once
#endif

#include "shared/types.h"

RAYMAP_SHARED_BEGIN

RAYMAP_CONSTANT uint kCubesAround = 4;  // An edge of the lattice.

// A lattice edge at which the sign changes although no triangle crosses it: surface is missing there.
struct MissingEdge {
  uint first;  // The sample that it leads from, to the next one along `axis`.
  uint axis;
  uint rimCubes;     // Bit c: triangles do cross a sign change of cube c around it; see `cubeAround`.
  float winding[2];  // Of the two samples.
};
RAYMAP_CHECK_SIZE(MissingEdge, 20);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MissingEdges {
  MissingEdge at[];
};
#endif

struct CloseHolesPush {
  RAYMAP_ADDRESS(Uints) crossed;  // Which edges triangles cross (crossed_edges.glsl).
  RAYMAP_ADDRESS(Floats) winding;
  RAYMAP_ADDRESS(Uints) count;         // Of missing edges, zero before,
  RAYMAP_ADDRESS(MissingEdges) edges;  // and the first `room` of them, in any order.
  uint room;
  uint crossedWords;
  uint gridX, gridY, gridZ;  // Samples of the grid.
  float threshold;
};
RAYMAP_CHECK_SIZE(CloseHolesPush, 56);

RAYMAP_SHARED_END
