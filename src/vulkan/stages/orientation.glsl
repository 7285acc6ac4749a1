// Declarations shared by the kernels of the orientation.

#include "vulkan/stages/orientation_push.h"
#include "vulkan/stages/ray_map.glsl"

layout(push_constant, scalar) uniform Push {
  OrientationPush push;
};

ivec3 gridDims() {
  return ivec3(push.gridX, push.gridY, push.gridZ);
}

uint sampleCount() {
  return push.gridX * push.gridY * push.gridZ;
}

ivec3 sampleAt(uint index) {
  const uint row = index / push.gridX;
  return ivec3(index % push.gridX, row % push.gridY, row / push.gridY);
}
