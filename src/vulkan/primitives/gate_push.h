#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct GatePush {
  RAYMAP_ADDRESS(Uints) word;     // 0: the gate is closed.
  RAYMAP_ADDRESS(Uints) planned;  // Dispatch arguments for an open gate.
  RAYMAP_ADDRESS(Uints) actual;   // Dispatch arguments to run.
  uint count;                     // Number of words in each of the two.
  uint unused;
};
RAYMAP_CHECK_SIZE(GatePush, 32);

RAYMAP_SHARED_END
