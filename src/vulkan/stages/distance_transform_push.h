#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRunCells = 16;  // Samples that an invocation finishes; a power of two.

// One pass: lines along one axis.
struct DistanceTransformPush {
  RAYMAP_ADDRESS(Floats) values;  // Values of the cells before all passes.
  RAYMAP_ADDRESS(Uints) from;     // Result of the pass before.
  RAYMAP_ADDRESS(Uints) to;       // Result: x of the nearest cell, then x | y << 16, then its index.
  uvec3 dims;
  uint lines;   // Lines per group, a power of two; used along y and z, as is `runs`.
  uint runs;    // Runs per line.
  float empty;  // Value of cells without triangles; used along x.
};
RAYMAP_CHECK_SIZE(DistanceTransformPush, 48);

RAYMAP_SHARED_END
