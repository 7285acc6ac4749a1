#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kWindingPathsGroup = 128;
RAYMAP_CONSTANT uint kPointsPerDispatch = 4;  // Offset points that fit into the parameters.

struct WindingPathsPush {
  RAYMAP_ADDRESS(Ints) rays[3];   // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) values;  // Values read at the offset points.
  RAYMAP_ADDRESS(Floats) sums;    // Initial sum of each sample.
  RAYMAP_ADDRESS(Floats) result;  // New sum of each sample, divided by `divisor`.
  float divisor;
  float sumScale;    // Factor of the initial sum.
  float pointScale;  // Factor of each point's contribution.
  uvec3 dims;
  uint pointCount;
  int offsets[3 * kPointsPerDispatch];
  uint firstGroup;  // Number of groups before this dispatch.
};
RAYMAP_CHECK_SIZE(WindingPathsPush, 128);

RAYMAP_SHARED_END
