#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kWindingRaysGroup = 256;
RAYMAP_CONSTANT uint kWindingRaysRows = 4;  // Samples of an invocation.

struct WindingRaysPush {
  RAYMAP_ADDRESS(Ints) rays[3];    // A ray map.
  RAYMAP_ADDRESS(Floats) winding;  // Of each sample.
  RAYMAP_ADDRESS(Uints) doubtful;  // One number, to be added to.
  uint dims[3];
  uint sampleCount;
};
RAYMAP_CHECK_SIZE(WindingRaysPush, 56);

RAYMAP_SHARED_END
