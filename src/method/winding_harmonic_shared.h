#ifdef __cplusplus
#pragma once
#include <glm/vec3.hpp>
#endif

// Extents of the harmonic winding number's lattices, the same on every backend (docs/signs.md). Level 0 is
// the grid itself. Coarser lattices reach `kHarmonicMargin` of their cells farther on every side, so that the
// field can fade out.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

#ifdef __cplusplus
using glm::ivec3;
#endif

// Even, so that a lattice's first sample lies on the next coarser lattice.
RAYMAP_CONSTANT int kHarmonicMargin = 4;

// Returns the number of a level's samples along each axis, of a grid with `dims`.
RAYMAP_FUNCTION ivec3 harmonicDims(ivec3 dims, uint level) {
  return level == 0 ? dims : ((dims - 1) >> int(level)) + 2 + 2 * kHarmonicMargin;
}

// Returns the first coordinate of a level's samples along each axis.
RAYMAP_FUNCTION int harmonicLow(uint level) {
  return level == 0 ? 0 : -kHarmonicMargin;
}

RAYMAP_SHARED_END
