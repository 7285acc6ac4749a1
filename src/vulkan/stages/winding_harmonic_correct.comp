// Adds a smooth correction from the next coarser lattice, linear between its samples.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"

void main() {
  const ivec3 dims = boxDims(push.level), coarse = boxDims(push.level + 1);
  const uint i = wholeInvocationIndex();
  if (i >= sampleCount(dims)) return;
  const ivec3 s = sampleAt(i, dims), low = coarseBelow(s), high = low + (s & 1);
  const float near = 0.5 * (0.5 * (coarseAt(low, coarse) + coarseAt(ivec3(high.x, low.yz), coarse)) +
                            0.5 * (coarseAt(ivec3(low.x, high.y, low.z), coarse) + coarseAt(ivec3(high.xy, low.z), coarse)));
  const float far = 0.5 * (0.5 * (coarseAt(ivec3(low.xy, high.z), coarse) + coarseAt(ivec3(high.x, low.y, high.z), coarse)) +
                           0.5 * (coarseAt(ivec3(low.x, high.yz), coarse) + coarseAt(high, coarse)));
  push.values.at[i] += 0.5 * (near + far);
}
