// Computes the position of each triangle's centroid along the Morton curve.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/surface_tree.glsl"
#include "vulkan/stages/surface_tree_places.glsl"

uint spread(uint v) {
  v = (v | v << 16) & 0x030000ffu;
  v = (v | v << 8) & 0x0300f00fu;
  v = (v | v << 4) & 0x030c30c3u;
  return (v | v << 2) & 0x09249249u;
}

void main() {
  const uint triangle = invocationIndex();
  if (triangle >= push.triangleCount) return;
  const uvec3 place = placeOf(triangle) >> (kPlaceBits - kMostKeyBits / 3);
  const uint key = spread(place.x) << 2 | spread(place.y) << 1 | spread(place.z);
  push.keys.at[triangle] = key >> (kMostKeyBits - push.keyBits);
  push.order.at[triangle] = triangle;
}
