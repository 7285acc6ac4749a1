#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"
#include "picture/drawn_scene_shared.h"
#include "picture/shade_shared.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRenderTile = 4;  // Pixels along a side of a group's tile.
RAYMAP_CONSTANT uint kRenderGroup = kRenderTile * kRenderTile * kSubPixelCount;  // A ray each.

struct RenderPicture {
  RenderSceneData scene;
  RenderColours colours;
  RAYMAP_ADDRESS(Uints) leafIndex;  // Of a narrow band, as `DrawnField::leafIndex` gives it.
};
RAYMAP_CHECK_SIZE(RenderPicture, 480);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer RenderPictures {
  RenderPicture at[];
};
#endif

struct RenderFieldPush {
  RAYMAP_ADDRESS(Floats) samples;
  RAYMAP_ADDRESS(Floats) values;  // Numbers in colour, if they are no distances.
  RAYMAP_ADDRESS(RenderPictures) picture;
  RAYMAP_ADDRESS(Uints) pixels;  // Red, green, blue, 255 from the lowest byte.
  RAYMAP_ADDRESS(Floats)
  depth;  // Distance from the eye to what a pixel shows, in units of the samples; 0: not wanted.
  RAYMAP_ADDRESS(Uints) steps;  // Sum over the pixels: steps of the mean ray. Used where steps are counted.
  RenderShape shape;
  uint width, height;
  uint firstRow, rows;
  float scale;  // Spacings per unit of the samples.
};
RAYMAP_CHECK_SIZE(RenderFieldPush, 128);

RAYMAP_SHARED_END
