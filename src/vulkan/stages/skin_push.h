#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct SkinPush {
  RAYMAP_ADDRESS(Floats) rest;      // Three numbers per vertex, at rest.
  RAYMAP_ADDRESS(Floats) vertices;  // Three numbers per vertex, moved.
  RAYMAP_ADDRESS(Uints) joints;     // Four 16-bit numbers per vertex; 0: the first joint moves all.
  RAYMAP_ADDRESS(Vec4s) weights;    // Four numbers per vertex.
  RAYMAP_ADDRESS(Vec4s) matrices;   // Three rows per joint.
  uint vertexCount;
  uint jointCount;
};
RAYMAP_CHECK_SIZE(SkinPush, 48);

RAYMAP_SHARED_END
