#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

// The steps of the search; a constant of the shader chooses one.
RAYMAP_CONSTANT uint kCountFaces = 0;
RAYMAP_CONSTANT uint kListFaces = 1;

struct FaceSearchPush {
  RAYMAP_ADDRESS(Uints) triangles;  // Three vertex indices each, all in range.
  RAYMAP_ADDRESS(Uint64s) vertexHashes;
  // All zero before:
  RAYMAP_ADDRESS(Uints) sums;    // 0 where all edges end evenly. Several edges share one.
  RAYMAP_ADDRESS(Uints) hashes;  // Hash table of faces, open addressing; 0 is empty.
  RAYMAP_ADDRESS(Uints) twice;   // A bit for each of `hashes`: whether two faces have it.
  RAYMAP_ADDRESS(Uints) counts;  // Number of edges, number of faces.
  // At most `room` of each, in any order:
  RAYMAP_ADDRESS(Uints) edges;
  RAYMAP_ADDRESS(Uints) faces;
  uint room;
  uint triangleCount;
  uint sumCount;   // A power of two.
  uint hashCount;  // A power of two, larger than the number of triangles.
};
RAYMAP_CHECK_SIZE(FaceSearchPush, 80);

RAYMAP_SHARED_END
