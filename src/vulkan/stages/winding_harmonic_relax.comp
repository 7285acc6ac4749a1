// Red-black relaxation: sets half of the inner samples to the mean of the values that their neighbours
// require.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"

void main() {
  const ivec3 dims = boxDims(push.level);
  const ivec3 pairs = ivec3((dims.x + 1) / 2, dims.yz);
  const uint i = wholeInvocationIndex();
  if (i >= sampleCount(pairs)) return;
  ivec3 s = sampleAt(i, pairs);
  s.x = 2 * s.x + ((s.y + s.z + int(push.colour) + 1) & 1);
  if (isInner(s, dims)) push.values.at[indexOf(s, dims)] = asked(s, dims) * (1.0 / 6.0);
}
