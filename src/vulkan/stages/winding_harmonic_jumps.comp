// Computes the right-hand side of a lattice's equations from the ray map (Krayer & Müller 2019, §3.5, Eq. 5).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"

void main() {
  const ivec3 dims = boxDims(push.level);
  const uint i = wholeInvocationIndex();
  if (i >= sampleCount(dims)) return;
  const ivec3 s = sampleAt(i, dims);
  push.values.at[i] = float(sumJumps(s));
}
