#ifdef __cplusplus
#pragma once
#endif

// How closely the winding number of the dipoles is looked at, the same on every backend (Barill et al. 2018).

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// The lattice is hardly ever farther from the winding number than this (docs/decisions/winding_dipoles.md).
// It knows least at the rims of the surface, at most so many cells away as the distance says.
RAYMAP_CONSTANT float kMostError = 0.15f;
RAYMAP_CONSTANT float kLeastError = 0.015f;
RAYMAP_CONSTANT float kMostErrorWithin = 2.0f;

// A group of triangles is distant from so many times its radius on, at first and when the number turns out so
// close to the threshold that the error, 0.002, 0.0002 and 0.00001 in the mean, could matter.
RAYMAP_CONSTANT uint kLooks = 3;
RAYMAP_CONSTANT float kDistant[kLooks] = {2.0f, 5.0f, 20.0f};
RAYMAP_CONSTANT float kClose[kLooks] = {0.03f, 0.004f, 0.0f};

RAYMAP_SHARED_END
