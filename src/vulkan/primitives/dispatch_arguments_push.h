#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/device/dispatch_limits.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct DispatchArgumentsPush {
  RAYMAP_ADDRESS(Uints) count;
  RAYMAP_ADDRESS(Uints) entries;  // A VkDispatchIndirectCommand for each part.
  uint most;                      // Upper bound of the count.
  uint itemsPerGroup;
  uint mostGroups;  // Groups of each part.
  uint parts;
};
RAYMAP_CHECK_SIZE(DispatchArgumentsPush, 32);

RAYMAP_SHARED_END
