#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct SubgroupSizesPush {
  RAYMAP_ADDRESS(Uints) sizes;  // One value per invocation of the only group.
};
RAYMAP_CHECK_SIZE(SubgroupSizesPush, 8);

RAYMAP_SHARED_END
