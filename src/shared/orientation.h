#ifdef __cplusplus
#pragma once
#endif

#include "shared/types.h"

RAYMAP_SHARED_BEGIN

RAYMAP_CONSTANT uint kMisfitGroup = 256;
RAYMAP_CONSTANT uint kMisfitSamples = 16;  // Of an invocation.

// Of every kernel that orientation takes.
struct OrientationPush {
  RAYMAP_ADDRESS(Ints) rays[3];     // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) field;     // Of every sample.
  RAYMAP_ADDRESS(Floats) vertices;  // In cells.
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Floats) rises;   // Of every triangle.
  RAYMAP_ADDRESS(Floats) misfit;  // Two numbers of each group.
  uint gridX, gridY, gridZ;
  uint triangleCount;
  float farSides;  // Steps along the normal are at least so many roots of twice the area,
  uint unused;     // and a cell.
};
RAYMAP_CHECK_SIZE(OrientationPush, 88);

RAYMAP_SHARED_END
