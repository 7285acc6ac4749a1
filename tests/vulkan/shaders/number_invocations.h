#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct NumberInvocationsPush {
  RAYMAP_ADDRESS(Uints) groups;  // Of each invocation the number of its group.
  uint count;
  uint groupSize;  // Must be what the kernel was made with.
};
RAYMAP_CHECK_SIZE(NumberInvocationsPush, 16);

RAYMAP_SHARED_END
