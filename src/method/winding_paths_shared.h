#ifdef __cplusplus
#pragma once
#endif

// Krayer & Müller 2019, §3.5, Eq. 9-11: the curves of a sample through offset points, on every backend.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

RAYMAP_CONSTANT int kPathsPerPoint = 6;  // xyz, xzy, yxz, yzx, zxy, zyx.

RAYMAP_SHARED_END
