#ifdef __cplusplus
#pragma once
#endif

// Margin from which on a sign is sure enough to contradict the parity, the same on every backend.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// The lattice's winding number is hardly ever off by more than this (docs/decisions/winding_dipoles.md).
RAYMAP_CONSTANT float kSureSign = 0.15f;

RAYMAP_SHARED_END
