// Lattice of the triangles' places, fitted to the mesh, or to its part near the grid.

#include "vulkan/primitives/ordered_float.glsl"

const uint kPlaceBits = 16;  // Per axis.

// Returns the place of the triangle's centroid.
uvec3 placeOf(uint triangle) {
  vec3 low, high;
  [[unroll]] for (uint axis = 0; axis < 3; ++axis) {
    low[axis] = fromOrdered(push.bounds.at[axis]);
    high[axis] = fromOrdered(~push.bounds.at[3 + axis]);
  }
  // Triangles far from the grid need no fine order.
  const vec3 dims = vec3(push.dims), nearLow = max(low, -dims), nearHigh = min(high, 2 * dims);
  if (all(lessThan(nearLow, nearHigh))) {
    low = nearLow;
    high = nearHigh;
  }
  const vec3 size = high - low;
  const float most = (1 << kPlaceBits) - 1, scale = most / (3 * max(max(size.x, size.y), max(size.z, 1e-20)));
  const vec3 thrice = readCorner(triangle, 0) + readCorner(triangle, 1) + readCorner(triangle, 2);
  return uvec3(clamp((thrice - 3 * low) * scale, 0, most)) & uint(most);
}
