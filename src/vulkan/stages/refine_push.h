#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "vulkan/stages/cell_levels_push.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRefineGroup = 128;

struct RefinePush {
  RAYMAP_ADDRESS(CellLevels) levels;
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Vec4s) frames;     // Of each triangle; see surface_shapes.glsl.
  RAYMAP_ADDRESS(Floats) distance;  // One value per sample.
  RAYMAP_ADDRESS(Uints) closest;    // Index of the closest triangle per sample; 0: not requested.
  RAYMAP_ADDRESS(Uints) crowded;    // Samples with so many triangles that a whole group measures them.
  RAYMAP_ADDRESS(Uints) crowdedCount;
  uvec3 dims;
  uint levelCount;
  uint reach;      // 1: also measures the neighbours of the nearest cell.
  uint mostAlone;  // Triangles that one invocation measures alone, at most.
  uint triangleCount;
  uint firstGroup;  // Number of groups before this dispatch.
};
RAYMAP_CHECK_SIZE(RefinePush, 96);

RAYMAP_SHARED_END
