#ifdef __cplusplus
#pragma once
#endif

// The field beside the faces, and the parity that it may contradict: the same on every backend.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// A sign this far from the threshold is sure enough to contradict the parity: the lattice's winding number is
// hardly ever off by more (docs/dev/decisions/winding_dipoles.md).
RAYMAP_CONSTANT float kSureSign = 0.15f;

// A face is measured in parts of about this length, in cells, up to this many along an edge.
RAYMAP_CONSTANT float kPartLength = 2.0f;
RAYMAP_CONSTANT float kMostParts = 8.0f;

RAYMAP_SHARED_END
