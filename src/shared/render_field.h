#ifdef __cplusplus
#pragma once
#endif

#include "shared/render_scene.h"
#include "shared/types.h"

RAYMAP_SHARED_BEGIN

RAYMAP_CONSTANT uint kRenderTile = 4;       // Pixels along a side of what a group draws,
RAYMAP_CONSTANT uint kRenderSubPixels = 4;  // each by so many rays: an invocation each.
RAYMAP_CONSTANT uint kRenderGroup = kRenderTile * kRenderTile * kRenderSubPixels;

struct RenderFieldPush {
  RAYMAP_ADDRESS(Floats) samples;  // In units of the spacing.
  RAYMAP_ADDRESS(RenderScenes) scene;
  RAYMAP_ADDRESS(Uints) pixels;  // Red, green, blue from the lowest byte.
  RenderShape shape;
  uint width, height;
  uint firstRow, rows;
};
RAYMAP_CHECK_SIZE(RenderFieldPush, 96);

RAYMAP_SHARED_END
