#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kSignedEach = 4;  // Samples of an invocation: more of them are on their way at once.

struct SignPush {
  RAYMAP_ADDRESS(Ints) rays[3];  // The ray map, by axis, for the confidence.
  RAYMAP_ADDRESS(Floats) winding;
  RAYMAP_ADDRESS(Floats) distance;    // Unsigned and in cells; becomes the result.
  RAYMAP_ADDRESS(Floats) confidence;  // 0: not requested.
  uint gridX, gridY, gridZ;           // Samples of the grid.
  float threshold;
  uint isInverted;  // Positive inside.
  uint unused;
};
RAYMAP_CHECK_SIZE(SignPush, 72);

RAYMAP_SHARED_END
