#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRayMapGroup = 128;
RAYMAP_CONSTANT uint kRayMapPiece = 1u << 15;  // Edges of a line that one dispatch sums: loops have limits.

struct RayMapPush {
  RAYMAP_ADDRESS(Ints) edges;  // Of all lines along an axis: their counts, replaced by the sums.
  uint lineCount;
  uint edgesOfLine;
  uint stride;  // From an edge of a line to the next, and the number of lines that lie side by side.
  uint end;     // The piece to be summed ends before this edge; what comes after it has been summed.
};
RAYMAP_CHECK_SIZE(RayMapPush, 24);

RAYMAP_SHARED_END
