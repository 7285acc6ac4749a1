#ifdef __cplusplus
#pragma once
#endif

#include "shared/types.h"

RAYMAP_SHARED_BEGIN

RAYMAP_CONSTANT uint kMaxGroups = 65535;  // In one dimension: what every device has.

// VkDispatchIndirectCommand and, after it, the number of groups times a factor.
struct DispatchArgumentsEntry {
  uint x, y, z;
  uint scaledGroups;
};
RAYMAP_CHECK_SIZE(DispatchArgumentsEntry, 16);

struct DispatchArgumentsPush {
  RAYMAP_ADDRESS(Uints) count;
  RAYMAP_ADDRESS(Uints) entry;  // A DispatchArgumentsEntry.
  uint most;                    // The count is at most this.
  uint itemsPerGroup;
  uint fewestGroups;
  uint scale;
};
RAYMAP_CHECK_SIZE(DispatchArgumentsPush, 32);

RAYMAP_SHARED_END
