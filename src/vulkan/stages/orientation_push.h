#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "method/orientation_sure.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kMisfitGroup = 256;
RAYMAP_CONSTANT uint kMisfitSamples = 16;  // Of an invocation.
RAYMAP_CONSTANT uint kMisfitNumbers = 3;   // Of a group: squares, jumps, samples that contradict the parity.

// Of every kernel that orientation takes.
struct OrientationPush {
  RAYMAP_ADDRESS(Ints) rays[3];     // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) field;     // Of every sample.
  RAYMAP_ADDRESS(Floats) vertices;  // In cells.
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Floats) rises;   // Of every triangle.
  RAYMAP_ADDRESS(Floats) misfit;  // kMisfitNumbers of each group.
  uint gridX, gridY, gridZ;
  uint triangleCount;
  float farSides;  // Steps along the normal are at least so many roots of twice the area, and a cell.
  float threshold;
};
RAYMAP_CHECK_SIZE(OrientationPush, 88);

RAYMAP_SHARED_END
