#ifdef __cplusplus
#pragma once
#include <glm/glm.hpp>
#endif

// Lattices on which winding numbers follow from rays and rims, the same on every backend. Level l has every
// 2^l-th sample of the grid, and ends with the first one at or beyond the grid's last.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

#ifdef __cplusplus
using glm::abs;
using glm::ivec3;
using glm::vec3;
#endif

// The six rays of a sample are tried in turn. One that passes all rims at this angle or more serves at once.
// Else the one that passes them farthest serves, unless its angle is below the least: a rim on the ray would
// leave the number undefined.
RAYMAP_CONSTANT float kClearOfRims = 0.05f;
RAYMAP_CONSTANT float kLeastClearance = 1e-4f;
// Returns the i-th ray to try of a sample at this offset from the centre of the rims: 0 to 2 run along x, y
// and z, 3 to 5 against them. Those that lead away from the rims come first.
RAYMAP_FUNCTION uint rayToTry(uint i, vec3 fromCentre) {
  const vec3 size = abs(fromCentre);
  const uint longest = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
  const uint axis = (longest + i) % 3u;
  const bool isForward = (fromCentre[axis] >= 0.0f) == (i < 3u);
  return isForward ? axis : axis + 3u;
}

// Stands for the infinitesimal by which all lines are displaced, where each ray meets a rim.
RAYMAP_CONSTANT float kDisplacement[3] = {0.015625f, 0.001953125f, 0.000244140625f};
// In double precision, this share of the last two constants serves.
RAYMAP_CONSTANT float kShareInDoubles = 0.0009765625f;
// Numbers are whole multiples of one over this, so that rounding puts none that equals the threshold beyond
// it.
RAYMAP_CONSTANT float kRimUnits = 262144.0f;

// Returns the number of a level's samples along each axis, of a grid with `dims`.
RAYMAP_FUNCTION ivec3 rimDims(ivec3 dims, uint level) {
  return ((dims - 2 + (1 << int(level))) >> int(level)) + 1;
}

RAYMAP_SHARED_END
