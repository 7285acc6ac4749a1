#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kSegmentCells = 17;  // Of a line, for one invocation; odd, so that banks do not collide.

// One pass: lines along one axis.
struct DistanceTransformPush {
  RAYMAP_ADDRESS(Floats) values;  // Of the cells, before all passes.
  RAYMAP_ADDRESS(Uints) from;     // What the pass before found, and
  RAYMAP_ADDRESS(Uints) to;  // what this one does: x of the nearest cell, then x | y << 16, then its index.
  uint nx, ny, nz;
  uint lines;     // Of a group; a power of two but along x.
  uint segments;  // Of a line.
  float empty;    // The value of cells without triangles.
};
RAYMAP_CHECK_SIZE(DistanceTransformPush, 48);

RAYMAP_SHARED_END
