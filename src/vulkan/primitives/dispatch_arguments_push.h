#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/device/dispatch_limits.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

// VkDispatchIndirectCommand, followed by the number of groups times a factor.
struct DispatchArgumentsEntry {
  uint x, y, z;
  uint scaledGroups;
};
RAYMAP_CHECK_SIZE(DispatchArgumentsEntry, 16);

struct DispatchArgumentsPush {
  RAYMAP_ADDRESS(Uints) count;
  RAYMAP_ADDRESS(Uints) entry;  // Address of a DispatchArgumentsEntry.
  uint most;                    // Upper bound of the count.
  uint itemsPerGroup;
  uint fewestGroups;
  uint scale;
  uint parts;       // Number of entries.
  uint mostGroups;  // Groups of each entry but the last.
};
RAYMAP_CHECK_SIZE(DispatchArgumentsPush, 40);

RAYMAP_SHARED_END
