#ifdef __cplusplus
#pragma once
#endif

#include "shared/types.h"

RAYMAP_SHARED_BEGIN

struct CellMeshPush {
  RAYMAP_ADDRESS(Floats) positions;  // Three numbers a vertex, in the mesh's units,
  RAYMAP_ADDRESS(Floats) vertices;   // and in cells.
  double shiftX, shiftY, shiftZ;     // From the grid's origin to the mesh's.
  double scale;                      // Cells to a unit.
  uint count;                        // Of vertices.
  uint unused;
};
RAYMAP_CHECK_SIZE(CellMeshPush, 56);

RAYMAP_SHARED_END
