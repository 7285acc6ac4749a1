#ifdef __cplusplus
#pragma once
#endif

#include "shared/types.h"

RAYMAP_SHARED_BEGIN

struct SignPush {
  RAYMAP_ADDRESS(Ints) rays[3];  // The ray map, by axis: for the confidence.
  RAYMAP_ADDRESS(Floats) winding;
  RAYMAP_ADDRESS(Floats) distance;    // Unsigned and in cells; becomes the result.
  RAYMAP_ADDRESS(Floats) confidence;  // 0: is not asked for.
  uint gridX, gridY, gridZ;           // Samples of the grid.
  float threshold;
  uint isInverted;  // Positive inside.
  uint unused;
};
RAYMAP_CHECK_SIZE(SignPush, 72);

struct FinishPush {
  RAYMAP_ADDRESS(Floats) distance;
  uint count;
  float band;   // In cells; may be infinite.
  float scale;  // The mesh's units to a cell.
  uint unused;
};
RAYMAP_CHECK_SIZE(FinishPush, 24);

RAYMAP_SHARED_END
