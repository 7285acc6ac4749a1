#ifdef __cplusplus
#pragma once
#endif

// Accuracy of the dipoles' winding number, the same on every backend (Barill et al. 2018).

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// Returns a bound on nearly all errors of the field that fits all crossings, at this distance from the
// surface in cells (docs/decisions/winding_dipoles.md). They are largest near the surface's rims.
RAYMAP_FUNCTION float latticeError(float distance) {
  return distance < 1.0f ? 0.3f : distance > 7.5f ? 0.04f : 0.3f / distance;
}

// A group of triangles is distant from `kDistant` times its radius on. If the number turns out to be within
// `kClose` of the threshold, the error could matter: the next look uses the next values. The mean error is
// 0.002, 0.0002 and 0.00001.
RAYMAP_CONSTANT uint kLooks = 3;
RAYMAP_CONSTANT float kDistant[kLooks] = {2.0f, 5.0f, 20.0f};
RAYMAP_CONSTANT float kClose[kLooks] = {0.03f, 0.004f, 0.0f};

RAYMAP_SHARED_END
