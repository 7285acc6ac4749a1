#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kFinishedEach = 4;  // Samples of an invocation: more of them are on their way at once.

struct FinishPush {
  RAYMAP_ADDRESS(Ints) rays[3];       // The ray map, by axis, for the confidence.
  RAYMAP_ADDRESS(Floats) winding;     // 0: distances stay unsigned.
  RAYMAP_ADDRESS(Floats) distance;    // Unsigned and in cells; becomes the result.
  RAYMAP_ADDRESS(Floats) confidence;  // 0: not requested.
  uvec3 dims;                         // Samples of the grid.
  float threshold;
  uint isInverted;  // Positive inside.
  float band;       // In cells; may be infinite.
  float scale;      // The mesh's units per cell.
  uint unused;
};
RAYMAP_CHECK_SIZE(FinishPush, 80);

RAYMAP_SHARED_END
