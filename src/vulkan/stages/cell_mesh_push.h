#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

// All zero before the stage begins. Triangle numbers are complemented, so that the first one is the maximum.
struct CellMeshStatus {
  uint bad;           // Number of nonfinite vertices plus number of bad triangles.
  uint badTriangles;  // Triangles with a nonfinite vertex or an index out of range.
  uint firstBad;      // The first of these.
  uint firstGood;
  uint outside;  // Triangles that reach beyond `low` or `high`.
};
RAYMAP_CHECK_SIZE(CellMeshStatus, 20);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CellMeshStatusAddress {
  CellMeshStatus now;
};
#endif

struct CellMeshPush {
  RAYMAP_ADDRESS(Floats) positions;  // Positions of the vertices, in the mesh's units.
  RAYMAP_ADDRESS(Uints) corners;     // Three vertex indices per triangle, from the caller.
  RAYMAP_ADDRESS(Floats) vertices;   // Three numbers per vertex, in cells.
  RAYMAP_ADDRESS(Uints) triangles;   // Checked copy of `corners`.
  RAYMAP_ADDRESS(CellMeshStatusAddress) status;
  RAYMAP_ADDRESS(Uint64s) hashes;   // Of the positions, for the search for faces; 0: not requested.
  uint64_t shiftX, shiftY, shiftZ;  // From the grid's origin to the mesh's; bits of doubles.
  uint64_t scale;                   // Cells per unit; bits of a double.
  uint stride;                      // Numbers from one position to the next.
  uint vertexCount;
  uint triangleCount;
  float low;  // The same on all axes.
  vec3 high;
  uint unused;
};
RAYMAP_CHECK_SIZE(CellMeshPush, 112);

RAYMAP_SHARED_END
