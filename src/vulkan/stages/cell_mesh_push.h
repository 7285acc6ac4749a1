#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

// All zero before the stage begins. Numbers of triangles are complemented, so that the first is the highest.
struct CellMeshStatus {
  uint bad;           // Vertices that are not finite, and triangles with such or with an index out of range;
  uint badTriangles;  // the latter alone,
  uint firstBad;      // and the first of them.
  uint firstGood;
  uint outside;  // Triangles beyond `low` and `high`.
};
RAYMAP_CHECK_SIZE(CellMeshStatus, 20);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CellMeshStatusAddress {
  CellMeshStatus now;
};
#endif

struct CellMeshPush {
  RAYMAP_ADDRESS(Floats) positions;  // Of vertices, in the mesh's units,
  RAYMAP_ADDRESS(Uints) corners;     // and three of them a triangle, as the caller has them.
  RAYMAP_ADDRESS(Floats) vertices;   // Three numbers a vertex, in cells.
  RAYMAP_ADDRESS(Uints) triangles;   // Checked.
  RAYMAP_ADDRESS(CellMeshStatusAddress) status;
  double shiftX, shiftY, shiftZ;  // From the grid's origin to the mesh's.
  double scale;                   // Cells to a unit.
  uint stride;                    // Numbers from one position to the next.
  uint vertexCount;
  uint triangleCount;
  float low;  // On all axes.
  float highX, highY, highZ;
  uint unused;
};
RAYMAP_CHECK_SIZE(CellMeshPush, 104);

RAYMAP_SHARED_END
