#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct CopyRatePush {
  RAYMAP_ADDRESS(Vec4s) from;
  RAYMAP_ADDRESS(Vec4s) to;
  uint count;
  uint unused;
};
RAYMAP_CHECK_SIZE(CopyRatePush, 24);

RAYMAP_SHARED_END
