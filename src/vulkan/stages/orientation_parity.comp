// Computes the share of each sample's six rays that cross an odd number of faces. A sum of +1 and -1 has the
// same parity as the number of terms.
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
