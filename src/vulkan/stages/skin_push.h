#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct SkinPush {
  RAYMAP_ADDRESS(Floats) rest;      // Three numbers a vertex, where no joint moves it,
  RAYMAP_ADDRESS(Floats) vertices;  // and where the joints do.
  RAYMAP_ADDRESS(Uints) joints;     // Four a vertex, of 16 bits each; 0: the first joint moves all.
  RAYMAP_ADDRESS(Vec4s) weights;    // Four a vertex.
  RAYMAP_ADDRESS(Vec4s) matrices;   // Three rows a joint.
  uint vertexCount;
  uint jointCount;
};
RAYMAP_CHECK_SIZE(SkinPush, 48);

RAYMAP_SHARED_END
