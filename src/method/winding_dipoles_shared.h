#ifdef __cplusplus
#pragma once
#endif

// Accuracy of the dipoles' winding number, the same on every backend (Barill et al. 2018).

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// A group of triangles is distant from `kDistant` times its radius on. If the number turns out to be within
// `kClose` of the threshold, the error could matter: the next look uses the next values, and rims decide
// after the last one. The mean error is 0.002, 0.0002 and 0.00001.
RAYMAP_CONSTANT uint kLooks = 3;
RAYMAP_CONSTANT float kDistant[kLooks] = {2.0f, 5.0f, 20.0f};
RAYMAP_CONSTANT float kClose[kLooks] = {0.03f, 0.004f, 0.0005f};

// Groups of many layers err more. The error of a group is at most about this much of its share, times the
// square of its radius over its distance. Groups err independently.
RAYMAP_CONSTANT float kErrorOfDipoles = 10.0f;

// At such a distance from the surface, in cells, single precision does not tell its sides apart.
RAYMAP_CONSTANT float kOnSurface = 0.001f;

RAYMAP_SHARED_END
