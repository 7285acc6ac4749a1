// Adds a smooth correction from the next coarser lattice.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"
#include "vulkan/stages/winding_harmonic_transfer.glsl"

float coarseAt(ivec3 s, ivec3 coarse) {
  return push.coarse.at[indexOf(s, coarse)];
}

void main() {
  const ivec3 dims = boxDims(push.level);
  const uint i = wholeInvocationIndex();
  if (i < countOf(uvec3(dims))) push.values.at[i] += correctionOf(sampleAt(i, dims), boxDims(push.level + 1));
}
