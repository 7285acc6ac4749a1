#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct DiscBoundsPush {
  RAYMAP_ADDRESS(Vec4s) discs;
  RAYMAP_ADDRESS(Vec4s) points;  // One for each disc.
  RAYMAP_ADDRESS(Vec4s) planes;  // Gradient and distance of the tangent plane.
  RAYMAP_ADDRESS(Floats) squared;
  uint count;
  uint unused;
};
RAYMAP_CHECK_SIZE(DiscBoundsPush, 40);

RAYMAP_SHARED_END
