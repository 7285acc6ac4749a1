#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct NumberInvocationsPush {
  RAYMAP_ADDRESS(Uints) groups;  // The number of each invocation's group.
  uint count;
  uint groupSize;   // Must be the size that the kernel was made with.
  uint firstGroup;  // Number of groups before this dispatch.
  uint unused;
};
RAYMAP_CHECK_SIZE(NumberInvocationsPush, 24);

RAYMAP_SHARED_END
