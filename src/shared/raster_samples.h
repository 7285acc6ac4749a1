#ifdef __cplusplus
#pragma once
#endif

#include "shared/cell_levels.h"
#include "shared/types.h"

RAYMAP_SHARED_BEGIN

struct RasterSamplesPush {
  RAYMAP_ADDRESS(CellLevels) levels;
  RAYMAP_ADDRESS(Floats) distance;
  uint nx, ny, nz;
  uint levelCount;
};
RAYMAP_CHECK_SIZE(RasterSamplesPush, 32);

RAYMAP_SHARED_END
