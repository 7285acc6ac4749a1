#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kWindingPathsGroup = 128;
RAYMAP_CONSTANT uint kPointsPerDispatch = 4;  // Offset points: what fits into the parameters.

struct WindingPathsPush {
  RAYMAP_ADDRESS(Ints) rays[3];   // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) values;  // What the samples at the offset points have.
  RAYMAP_ADDRESS(Floats) sums;    // What each sample starts from,
  RAYMAP_ADDRESS(Floats) result;  // and where its new sum goes.
  double factor;                  // Of the new sum.
  float sumScale;                 // Of what samples start from,
  float pointScale;               // and of what each point adds.
  uint dims[3];
  uint pointCount;
  int offsets[3 * kPointsPerDispatch];
};
RAYMAP_CHECK_SIZE(WindingPathsPush, 128);

RAYMAP_SHARED_END
