#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kMaxGroups = 65535;  // Work groups along one dimension that every device allows.

RAYMAP_SHARED_END
