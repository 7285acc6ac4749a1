#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kWindingRaysGroup = 256;
RAYMAP_CONSTANT uint kWindingRaysRows = 4;  // Samples per invocation.

struct WindingRaysPush {
  RAYMAP_ADDRESS(Ints) rays[3];    // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) winding;  // One value per sample.
  RAYMAP_ADDRESS(Uints) doubtful;  // Counter of doubtful samples.
  uvec3 dims;
  uint sampleCount;
};
RAYMAP_CHECK_SIZE(WindingRaysPush, 56);

RAYMAP_SHARED_END
