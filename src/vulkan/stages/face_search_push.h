#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct FaceSearchPush {
  RAYMAP_ADDRESS(Floats) positions;  // Of the vertices, in the mesh's units.
  RAYMAP_ADDRESS(Uints) corners;     // Three vertex indices per triangle.
  // All zero before:
  RAYMAP_ADDRESS(Uints) sums;    // 0 where all edges end evenly. Several edges share one.
  RAYMAP_ADDRESS(Uints) hashes;  // Hash table of faces, open addressing; 0 is empty.
  RAYMAP_ADDRESS(Uints) twice;   // A bit for each of `hashes`: whether two faces have it.
  RAYMAP_ADDRESS(Uints) counts;  // Number of edges, number of faces.
  // At most `room` of each, in any order:
  RAYMAP_ADDRESS(Uints) edges;
  RAYMAP_ADDRESS(Uints) faces;
  uint room;
  uint stride;  // Numbers from one position to the next.
  uint triangleCount;
  uint sumCount;   // A power of two.
  uint hashCount;  // A power of two, larger than the number of triangles.
  uint unused;
};
RAYMAP_CHECK_SIZE(FaceSearchPush, 88);

RAYMAP_SHARED_END
