// Restricts the residual of a lattice to the next coarser one, and begins to relax that one from zero.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"
#include "vulkan/stages/winding_harmonic_transfer.glsl"

const ivec3 kTile = ivec3(kRestrictX, kRestrictY, kRestrictZ);
const ivec3 kHalo = 2 * kTile + 1;

shared float residual[kHalo.x * kHalo.y * kHalo.z];

float valueAt(uint i) {
  return push.values.at[i];
}

float residualAt(uint i) {
  return residual[i];
}

// Loads the residuals of all samples that the group's coarse samples depend on; zero outside and on the rim.
void loadResiduals(ivec3 first, ivec3 dims) {
  const uint count = countOf(uvec3(kHalo));
  for (uint i = gl_LocalInvocationIndex; i < count; i += gl_WorkGroupSize.x)
    residual[i] = residualOf(first + sampleAt(i, kHalo), dims);
}

void main() {
  const ivec3 coarse = boxDims(push.level + 1), tiles = (coarse + kTile - 1) / kTile;
  const uint group = wholeGroupIndex();
  if (group >= countOf(uvec3(tiles))) return;
  const ivec3 low = sampleAt(group, tiles) * kTile;
  loadResiduals(2 * (low - coarseBefore()) - 1, boxDims(push.level));
  barrier();
  const ivec3 local = sampleAt(gl_LocalInvocationIndex, kTile), s = low + local;
  if (any(greaterThanEqual(s, coarse))) return;
  const uvec3 strides = uvec3(1, kHalo.x, kHalo.x * kHalo.y);
  const float asked = restricted(indexOf(2 * local + 1, kHalo), strides, strides);
  push.coarseEquations.at[indexOf(s, coarse)] = asked;
  push.coarse.at[indexOf(s, coarse)] = isFirstColour(s) && isInner(s, coarse) ? asked * (1.0 / 6.0) : 0.0;
}
