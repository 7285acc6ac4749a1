#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/device/dispatch_limits.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct DispatchArgumentsPush {
  RAYMAP_ADDRESS(Uints) number;   // Of items; with planned groups, 0 if none of them runs.
  RAYMAP_ADDRESS(Uints) planned;  // Groups of each part; 0: those that the items need.
  RAYMAP_ADDRESS(Uints) entries;  // A VkDispatchIndirectCommand for each part.
  uint most;                      // Upper bound of the number of items.
  uint itemsPerGroup;
  uint mostGroups;  // Groups of each part.
  uint parts;
};
RAYMAP_CHECK_SIZE(DispatchArgumentsPush, 40);

RAYMAP_SHARED_END
