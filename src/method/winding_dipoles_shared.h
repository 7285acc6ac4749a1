#ifdef __cplusplus
#pragma once
#endif

// Accuracy of the dipoles' winding number, the same on every backend (Barill et al. 2018).

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// The lattice's error is hardly ever larger than this bound (docs/decisions/winding_dipoles.md). It is
// largest near the surface's rims. Within `kMostErrorWithin` cells of the surface the bound is
// `kMostDipoleError`. Farther away it falls with the reciprocal of the distance, down to `kLeastDipoleError`.
RAYMAP_CONSTANT float kMostDipoleError = 0.15f;
RAYMAP_CONSTANT float kLeastDipoleError = 0.015f;
RAYMAP_CONSTANT float kMostErrorWithin = 2.0f;

// A group of triangles is distant from `kDistant` times its radius on. If the number turns out to be within
// `kClose` of the threshold, the error could matter: the next look uses the next values. The mean error is
// 0.002, 0.0002 and 0.00001.
RAYMAP_CONSTANT uint kLooks = 3;
RAYMAP_CONSTANT float kDistant[kLooks] = {2.0f, 5.0f, 20.0f};
RAYMAP_CONSTANT float kClose[kLooks] = {0.03f, 0.004f, 0.0f};

RAYMAP_SHARED_END
