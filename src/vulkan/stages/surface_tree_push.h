#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kArity = 8;        // Children of a node, and triangles of a leaf.
RAYMAP_CONSTANT uint kBoundsWords = 6;  // Three lows and three highs.
RAYMAP_CONSTANT uint kMortonBits = 30;
RAYMAP_CONSTANT uint kDiscVectors = 2;   // A disc with thickness: centre, radius; normal, half the thickness.
RAYMAP_CONSTANT uint kFrameVectors = 4;  // A triangle in a frame of its own: see surface_shapes.glsl.

struct SurfaceTreePush {
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Uints) bounds;  // Of the vertices, as numbers that are ordered alike.
  RAYMAP_ADDRESS(Uints) keys;
  RAYMAP_ADDRESS(Uints) order;  // The triangles in the order of their keys.
  RAYMAP_ADDRESS(Vec4s) frames;
  RAYMAP_ADDRESS(Vec4s) discs;
  uint vertexCount;
  uint triangleCount;
  uint dimX, dimY, dimZ;
  uint levelStart;       // The first node of the level that is written;
  uint levelCount;       // how many of its nodes have triangles,
  uint levelBelowCount;  // and of those of the level below.
};
RAYMAP_CHECK_SIZE(SurfaceTreePush, 88);

RAYMAP_SHARED_END
