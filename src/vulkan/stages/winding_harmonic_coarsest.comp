// Solves the coarsest lattice, starting from zero, by over-relaxation (Young 1954) in one work group.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"

layout(constant_id = 1) const uint kSweeps = 1;

shared float field[kMostCoarsest];

void relax(ivec3 s, ivec3 dims) {
  const uint i = indexOf(s, dims), row = uint(dims.x), plane = row * uint(dims.y);
  const float sum = (field[i - 1] + field[i + 1]) + (field[i - row] + field[i + row]) +
                    ((field[i - plane] + field[i + plane]) + rightHandSide(s, dims));
  field[i] += push.factor * (sum * (1.0 / 6.0) - field[i]);
}

void main() {
  if (groupIndex() > 0) return;
  const ivec3 dims = boxDims(push.level);
  const uint count = sampleCount(dims);
  for (uint i = gl_LocalInvocationIndex; i < count; i += gl_WorkGroupSize.x) field[i] = 0.0;
  barrier();
  for (uint halfSweep = 0; halfSweep < 2 * kSweeps; ++halfSweep) {
    for (uint i = gl_LocalInvocationIndex; i < count; i += gl_WorkGroupSize.x) {
      const ivec3 s = sampleAt(i, dims);
      if (isInner(s, dims) && ((s.x + s.y + s.z + int(halfSweep) + 1) & 1) == 0) relax(s, dims);
    }
    barrier();
  }
  for (uint i = gl_LocalInvocationIndex; i < count; i += gl_WorkGroupSize.x) push.values.at[i] = field[i];
}
