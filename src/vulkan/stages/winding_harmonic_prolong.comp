// Prolongs a field to the next finer lattice. A new sample between two old ones is the mean of the values
// that both require over the lattice edges between. The field thus keeps its jumps where the crossings are.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"

float halfJump(Ints rays, uint axis, ivec3 s) {
  return 0.5 * float(jumpAlong(rays, axis, s));
}

// Returns the value in a row with even y and z, which may lie just beyond the box.
float alongX(ivec3 s, ivec3 dims, ivec3 coarse) {
  const ivec3 low = coarseBelow(s);
  if ((s.x & 1) == 0) return coarseAt(low, coarse);
  const float mean = 0.5 * (coarseAt(low, coarse) + coarseAt(low + ivec3(1, 0, 0), coarse));
  return s.y < dims.y && s.z < dims.z ? mean + halfJump(push.rays[0], 0, s) : mean;
}

// Returns the value in a plane with even z, which may lie just beyond the box.
float alongXY(ivec3 s, ivec3 dims, ivec3 coarse) {
  if ((s.y & 1) == 0) return alongX(s, dims, coarse);
  const float mean = 0.5 * (alongX(s - ivec3(0, 1, 0), dims, coarse) + alongX(s + ivec3(0, 1, 0), dims, coarse));
  return s.z < dims.z ? mean + halfJump(push.rays[1], 1, s) : mean;
}

void main() {
  const ivec3 dims = boxDims(push.level), coarse = boxDims(push.level + 1);
  const uint i = wholeInvocationIndex();
  if (i >= sampleCount(dims)) return;
  const ivec3 s = sampleAt(i, dims);
  float value = alongXY(s - ivec3(0, 0, s.z & 1), dims, coarse);
  if ((s.z & 1) != 0) value = 0.5 * (value + alongXY(s + ivec3(0, 0, 1), dims, coarse)) + halfJump(push.rays[2], 2, s);
  push.values.at[i] = value;
}
