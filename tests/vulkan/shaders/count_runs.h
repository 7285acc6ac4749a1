#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct CountRunsPush {
  RAYMAP_ADDRESS(Uints) runs;  // Invocations that ran with each group's number.
  uint count;                  // Length of that list.
  uint firstGroup;             // Number of groups before this dispatch.
};
RAYMAP_CHECK_SIZE(CountRunsPush, 16);

RAYMAP_SHARED_END
