#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct UnevenBarriersPush {
  RAYMAP_ADDRESS(Uints) reached;  // Per subgroup: 1 if it got past its barriers.
};
RAYMAP_CHECK_SIZE(UnevenBarriersPush, 8);

RAYMAP_SHARED_END
