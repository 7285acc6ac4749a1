#ifdef __cplusplus
#pragma once
#endif

// Rounding of the cells that a triangle touches, the same on every backend.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// Share of the triangle's reach by which cells are enlarged, to make up for rounding in double precision: the
// bits of the double 1e-12, because shaders compute with doubles in software.
RAYMAP_CONSTANT uint64_t kSlackBits = 0x3d719799812dea11ul;

RAYMAP_SHARED_END
