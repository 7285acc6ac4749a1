#ifdef __cplusplus
#pragma once
#include <cmath>
#endif

// How far winding numbers may be wrong before dipoles or rims decide, the same on every backend
// (docs/dev/decisions/rims.md).

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

#ifdef __cplusplus
using std::abs;
#endif

// Sources of the numbers: interpolation between numbers that follow from rims, or the field that fits all
// crossings.
RAYMAP_CONSTANT uint kFromRims = 0u;
RAYMAP_CONSTANT uint kFromFit = 1u;

// Returns a bound on nearly all errors of the field that fits all crossings, at this distance from the
// surface in cells (docs/dev/decisions/winding_dipoles.md). They are largest near the surface's rims.
RAYMAP_FUNCTION float latticeError(float distance) {
  return distance < 1.0f ? 0.3f : distance > 7.5f ? 0.04f : 0.3f / distance;
}

// Returns such a bound for numbers of a source. No rim is closer than the surface, and the error of
// interpolation falls with the square of the rim's distance.
RAYMAP_FUNCTION float numberError(uint source, float distance) {
  if (source == kFromFit) return latticeError(distance);
  return distance < 7.0f ? 0.08f : distance > 28.0f ? 0.005f : 4.0f / (distance * distance);
}

// Such bounds hold for rims of one face. Others change the field along crossed edges of the lattice by
// more than what is crossed. All bounds grow with the largest such change, times this.
RAYMAP_CONSTANT float kDoubtOfChange = 3.0f;

// Returns whether a number may lie on the wrong side of the threshold.
RAYMAP_FUNCTION bool isDoubtful(float winding, float threshold, uint source, float distance,
                                float largestChange) {
  const float scale = kDoubtOfChange * largestChange;
  return abs(abs(winding) - threshold) < (scale > 1.0f ? scale : 1.0f) * numberError(source, distance);
}

RAYMAP_SHARED_END
