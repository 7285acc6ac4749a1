#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct GatePush {
  RAYMAP_ADDRESS(Uints) word;     // 0: the gate is shut.
  RAYMAP_ADDRESS(Uints) planned;  // Arguments of dispatches, as they are if it is open,
  RAYMAP_ADDRESS(Uints) actual;   // and as they shall be.
  uint count;                     // How many numbers these are.
  uint unused;
};
RAYMAP_CHECK_SIZE(GatePush, 32);

RAYMAP_SHARED_END
