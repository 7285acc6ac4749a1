#ifdef __cplusplus
#pragma once
#endif

// Index that stands for no cell, the same on every backend.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

RAYMAP_CONSTANT uint kNoCell = 0xffffffffu;

RAYMAP_SHARED_END
