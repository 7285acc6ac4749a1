#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct WaveVerticesPush {
  RAYMAP_ADDRESS(Floats) rest;  // Three per vertex.
  RAYMAP_ADDRESS(Floats) moved;
  uint count;  // Number of vertices.
  float time;
};
RAYMAP_CHECK_SIZE(WaveVerticesPush, 24);

RAYMAP_SHARED_END
