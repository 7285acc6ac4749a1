// Restricts the residual of a lattice to the next coarser one: full weighting, in the units of the coarser
// equations, whose cells are twice as wide.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"

const ivec3 kTile = ivec3(kRestrictX, kRestrictY, kRestrictZ);
const ivec3 kHalo = 2 * kTile + 1;

shared float residual[kHalo.x * kHalo.y * kHalo.z];

// Loads the residuals of all samples that the group's coarse samples depend on; zero outside and on the rim.
void loadResiduals(ivec3 first, ivec3 dims) {
  const uint count = sampleCount(kHalo);
  for (uint i = gl_LocalInvocationIndex; i < count; i += gl_WorkGroupSize.x) {
    const ivec3 s = first + sampleAt(i, kHalo);
    residual[i] = isInner(s, dims) ? asked(s, dims) - 6.0 * push.values.at[indexOf(s, dims)] : 0.0;
  }
}

float alongX(uint i) {
  return 0.5 * residual[i] + 0.25 * (residual[i - 1] + residual[i + 1]);
}

float alongXY(uint i) {
  return 0.5 * alongX(i) + 0.25 * (alongX(i - kHalo.x) + alongX(i + kHalo.x));
}

void main() {
  const ivec3 dims = boxDims(push.level), coarse = boxDims(push.level + 1);
  const ivec3 tiles = (coarse + kTile - 1) / kTile;
  const uint group = wholeGroupIndex();
  if (group >= sampleCount(tiles)) return;
  const ivec3 low = sampleAt(group, tiles) * kTile;
  const int shift = harmonicLow(push.level) / 2 - harmonicLow(push.level + 1);
  loadResiduals(2 * (low - shift) - 1, dims);
  barrier();
  const ivec3 local = sampleAt(gl_LocalInvocationIndex, kTile);
  if (any(greaterThanEqual(low + local, coarse))) return;
  const uint i = indexOf(2 * local + 1, kHalo);
  const uint plane = kHalo.x * kHalo.y;
  push.coarse.at[indexOf(low + local, coarse)] = 2.0 * alongXY(i) + (alongXY(i - plane) + alongXY(i + plane));
}
