// The share of the six rays of each sample that cross an odd number of faces: a sum of +1 and -1 is as odd as their
// number.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/orientation.glsl"

void main() {
  const uint index = invocationIndex();
  if (index >= sampleCount()) return;
  const ivec3 dims = gridDims(), s = sampleAt(index);
  int odd = 0;
  for (uint axis = 0; axis < 3; ++axis) {
    ivec3 before = s;
    before[axis] = -1;
    const int ray = rayFrom(push.rays[axis], axis, dims, s);
    odd += (ray & 1) + ((ray - rayFrom(push.rays[axis], axis, dims, before)) & 1);
  }
  push.field.at[index] = float(odd) / 6.0;
}
