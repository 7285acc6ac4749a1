// Red-black relaxation: sets half of the inner samples to the mean of the values that their neighbours
// require.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"

float valueAt(uint i) {
  return push.values.at[i];
}

void main() {
  const ivec3 dims = boxDims(push.level), pairs = pairDims(dims);
  const uint i = wholeInvocationIndex();
  if (i >= countOf(uvec3(pairs))) return;
  const ivec3 s = sampleOfPair(sampleAt(i, pairs), push.colour);
  if (isInner(s, dims)) push.values.at[indexOf(s, dims)] = asked(s, dims) * (1.0 / 6.0);
}
