#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kWindingDoubtsSamples = 8;  // Samples per invocation.

struct WindingDoubtsPush {
  RAYMAP_ADDRESS(Ints) rays[3];       // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) winding;     // One value per sample.
  RAYMAP_ADDRESS(Uints) change;       // The largest change, as the bits of a float.
  RAYMAP_ADDRESS(Uints) disagreeing;  // Number of samples whose rays disagree; if 0, nothing is doubted.
  uvec3 dims;                         // Samples of the grid.
  uint unused;
};
RAYMAP_CHECK_SIZE(WindingDoubtsPush, 64);

RAYMAP_SHARED_END
