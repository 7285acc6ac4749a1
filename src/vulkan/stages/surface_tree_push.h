#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kTreeArity = 8;     // Children per node, and triangles per leaf.
RAYMAP_CONSTANT uint kBoundsWords = 6;   // Three lows and three highs.
RAYMAP_CONSTANT uint kVerticesEach = 8;  // Vertices that an invocation takes into the bounds.
RAYMAP_CONSTANT uint kMostKeyBits = 30;
RAYMAP_CONSTANT uint kDiscVectors = 2;   // Disc with thickness: centre, radius; normal, half the thickness.
RAYMAP_CONSTANT uint kFrameVectors = 4;  // Triangle in a frame of its own: see surface_shapes.glsl.

struct SurfaceTreePush {
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Uints) bounds;  // Bounds of the vertices, as integers in the floats' order.
  RAYMAP_ADDRESS(Uints) keys;
  RAYMAP_ADDRESS(Uints) order;  // Triangles in the order of their keys.
  RAYMAP_ADDRESS(Vec4s) frames;
  RAYMAP_ADDRESS(Vec4s) discs;
  uint vertexCount;
  uint triangleCount;
  uvec3 dims;
  uint levelStart;       // First node of the level to be written.
  uint levelCount;       // Nodes of that level that have triangles.
  uint levelBelowCount;  // Nodes of the level below that have triangles.
  uint keyBits;          // Bits of the keys, of which a third belongs to each axis, x first.
  uint unused;
};
RAYMAP_CHECK_SIZE(SurfaceTreePush, 96);

RAYMAP_SHARED_END
