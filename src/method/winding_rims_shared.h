#ifdef __cplusplus
#pragma once
#include <glm/vec3.hpp>
#endif

// Lattices on which winding numbers follow from rays and rims, the same on every backend. Level l has every 2^l-th sample
// of the grid, and ends with the first one at or beyond the grid's last.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

#ifdef __cplusplus
using glm::ivec3;
#endif

// A ray that passes all rims at this angle or more is used; a rim on the ray would leave the number undefined.
RAYMAP_CONSTANT float kClearOfRims = 1e-2f;
// Numbers are whole multiples of one over this, so that rounding puts none that equals the threshold beyond it.
RAYMAP_CONSTANT float kRimUnits = 262144.0f;

// Returns a bound on the error of an interpolated number, at this distance from the surface in cells. No rim is closer than
// the surface. The error falls with the square of the rim's distance.
RAYMAP_FUNCTION float rimError(float distance) {
  return distance < 7.0f ? 0.08f : distance > 28.0f ? 0.005f : 4.0f / (distance * distance);
}

// Returns the number of a level's samples along each axis, of a grid with `dims`.
RAYMAP_FUNCTION ivec3 rimDims(ivec3 dims, uint level) {
  return ((dims - 2 + (1 << int(level))) >> int(level)) + 1;
}

RAYMAP_SHARED_END
