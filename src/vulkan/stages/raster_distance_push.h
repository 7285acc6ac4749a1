#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/stages/cell_levels_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct RasterDistancePush {
  RAYMAP_ADDRESS(CellLevels) levels;
  RAYMAP_ADDRESS(Floats) distance;
  uvec3 dims;
  uint levelCount;
};
RAYMAP_CHECK_SIZE(RasterDistancePush, 32);

RAYMAP_SHARED_END
