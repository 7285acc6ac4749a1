#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct HalfFloatsPush {
  RAYMAP_ADDRESS(Floats) values;
  RAYMAP_ADDRESS(Uints) halves;  // Two per word.
  uint count;                    // Number of values.
  uint unused;
};
RAYMAP_CHECK_SIZE(HalfFloatsPush, 24);

RAYMAP_SHARED_END
