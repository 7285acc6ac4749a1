#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRayMapGroup = 128;
RAYMAP_CONSTANT uint kRayMapPiece = 1u << 15;  // Edges of a line per dispatch: some drivers limit loops.

struct RayMapPush {
  RAYMAP_ADDRESS(Ints) edges;  // Counts of all lines along an axis, replaced by the sums.
  uint lineCount;
  uint edgesOfLine;
  uint stride;  // From one edge of a line to the next; also the number of adjacent lines.
  uint end;     // End of the piece to sum; later edges hold their sums already.
};
RAYMAP_CHECK_SIZE(RayMapPush, 24);

RAYMAP_SHARED_END
