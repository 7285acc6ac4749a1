#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct CountedLoopsPush {
  RAYMAP_ADDRESS(Uints) values;
  RAYMAP_ADDRESS(Uints) sums;  // Of `first` values, and of `more` for each invocation before.
  uint first;
  uint more;
};
RAYMAP_CHECK_SIZE(CountedLoopsPush, 24);

RAYMAP_SHARED_END
