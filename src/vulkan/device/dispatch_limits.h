#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kMaxGroups = 65535;  // Work groups along one dimension that every device allows.

// Invocations of one dispatch. More become several dispatches: a system resets a device that works on one for
// seconds.
RAYMAP_CONSTANT uint kMostInvocations = 1 << 22;
// The same for work groups, where the device decides how many there are.
RAYMAP_CONSTANT uint kMostGroups = 1 << 15;

RAYMAP_SHARED_END
