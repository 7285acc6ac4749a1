#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kFinishedEach = 4;  // Samples of an invocation: more of them are on their way at once.

struct FinishPush {
  RAYMAP_ADDRESS(Floats) distance;
  uint count;
  float band;   // In cells; may be infinite.
  float scale;  // The mesh's units per cell.
  uint unused;
};
RAYMAP_CHECK_SIZE(FinishPush, 24);

RAYMAP_SHARED_END
