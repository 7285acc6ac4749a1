#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "method/orientation_shared.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kMisfitGroup = 256;
RAYMAP_CONSTANT uint kMisfitSamples = 16;  // Samples per invocation.
RAYMAP_CONSTANT uint kMisfitNumbers = 3;   // Per group: squares, jumps, samples that contradict the parity.

// Parameters of all kernels of the orientation.
struct OrientationPush {
  RAYMAP_ADDRESS(Ints) rays[3];     // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) field;     // One value per sample.
  RAYMAP_ADDRESS(Floats) vertices;  // In cells.
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Floats) sides;   // One value per triangle.
  RAYMAP_ADDRESS(Floats) misfit;  // kMisfitNumbers per group.
  uvec3 dims;
  uint triangleCount;
  float farSides;  // Step along the normal, in roots of twice the face's area; at least a cell.
  float threshold;
  uint isWholeness;  // Whether to measure how whole the field is, not its rise.
  uint unused;
};
RAYMAP_CHECK_SIZE(OrientationPush, 96);

RAYMAP_SHARED_END
