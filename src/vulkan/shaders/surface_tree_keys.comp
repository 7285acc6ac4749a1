// Position of each triangle's centroid along the Morton curve.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel.glsl"
#include "surface_tree.glsl"
#include "ordered_float.glsl"

const float kMostPlace = 1023;

uint spread(uint v) {
  v = (v | v << 16) & 0x030000ffu;
  v = (v | v << 8) & 0x0300f00fu;
  v = (v | v << 4) & 0x030c30c3u;
  return (v | v << 2) & 0x09249249u;
}

void main() {
  const uint triangle = invocationIndex();
  if (triangle >= push.triangleCount) return;
  vec3 low, high;
  [[unroll]] for (uint axis = 0; axis < 3; ++axis) {
    low[axis] = fromOrdered(push.bounds.at[axis]);
    high[axis] = fromOrdered(~push.bounds.at[3 + axis]);
  }
  // What lies far from the grid needs no fine order.
  const vec3 dims = vec3(push.dimX, push.dimY, push.dimZ), nearLow = max(low, -dims), nearHigh = min(high, 2 * dims);
  if (all(lessThan(nearLow, nearHigh))) {
    low = nearLow;
    high = nearHigh;
  }
  const vec3 size = high - low;
  const float scale = kMostPlace / (3 * max(max(size.x, size.y), max(size.z, 1e-20)));
  const vec3 thrice = readCorner(triangle, 0) + readCorner(triangle, 1) + readCorner(triangle, 2);
  const uvec3 place = uvec3(clamp((thrice - 3 * low) * scale, 0, kMostPlace)) & 0x3ffu;
  push.keys.at[triangle] = spread(place.x) << 2 | spread(place.y) << 1 | spread(place.z);
  push.order.at[triangle] = triangle;
}
