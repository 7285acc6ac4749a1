#ifdef __cplusplus
#pragma once
#endif

// Coordinates of triangles in units of 2^-bits cells, the same on every backend (Krayer & Müller 2019, §3.5).

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

RAYMAP_CONSTANT int kMaxFractionBits = 20;
RAYMAP_CONSTANT int kCoordinateBits = 40;  // |coordinate| < 2^40, so that orient3d fits into 128 bits.
RAYMAP_CONSTANT int kNarrowBits = 30;      // Triangles less than 2^30 wide: orient2d fits into 64 bits.

RAYMAP_SHARED_END
