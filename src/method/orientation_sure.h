#ifdef __cplusplus
#pragma once
#endif

// When a sign is sure enough to contradict parity, the same on every backend.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// The lattice's winding number is hardly ever farther off (docs/decisions/winding_dipoles.md).
RAYMAP_CONSTANT float kSureSign = 0.15f;

RAYMAP_SHARED_END
