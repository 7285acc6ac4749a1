#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "method/close_holes_shared.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer MissingEdges {
  MissingEdge at[];
};
#endif

struct CloseHolesPush {
  RAYMAP_ADDRESS(Uints) crossed;  // Bits of the edges that triangles cross (crossed_edges.glsl).
  RAYMAP_ADDRESS(Floats) winding;
  RAYMAP_ADDRESS(Uints) count;         // Number of missing edges, zero before.
  RAYMAP_ADDRESS(MissingEdges) edges;  // At most `room` of them, in any order.
  uint room;
  uint crossedWords;
  uvec3 dims;  // Samples of the grid.
  float threshold;
};
RAYMAP_CHECK_SIZE(CloseHolesPush, 56);

RAYMAP_SHARED_END
