// Measures how badly the field fits the crossings, and whether signs contradict the parity
// (cpu/sign/orientation.cpp). Each group sums its samples, always in the same order.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/orientation.glsl"

shared vec3 sumsOf[kMisfitGroup];

void addEdge(Ints rays, uint axis, uint index, ivec3 s, uint stride, inout vec3 sums) {
  const int jump = crossingsOfEdge(rays, axis, gridDims(), s);
  if (jump == 0) return;
  const float fall = push.field.at[index] - push.field.at[index + stride];
  sums.xy += vec2(float(jump) * (float(jump) - fall), abs(float(jump)));
}

// Returns whether the winding number is far from the threshold but the parity of all six rays contradicts its
// sign.
bool contradictsParity(uint index, ivec3 s) {
  const int odd = countOddRays(s);
  const float excess = abs(push.field.at[index]) - push.threshold;
  return abs(excess) > kSureSign && odd == (excess > 0.0 ? 0 : 6);
}

void main() {
  const uint lane = gl_LocalInvocationIndex;
  vec3 sums = vec3(0.0);
  for (uint n = 0; n < kMisfitSamples; ++n) {
    const uint index = (groupIndex() * kMisfitSamples + n) * kMisfitGroup + lane;
    if (index >= countOf(push.dims)) break;
    const ivec3 s = ivec3(placeOf(index, push.dims));
    addEdge(push.rays[0], 0, index, s, 1, sums);
    addEdge(push.rays[1], 1, index, s, push.dims.x, sums);
    addEdge(push.rays[2], 2, index, s, push.dims.x * push.dims.y, sums);
    sums.z += float(contradictsParity(index, s));
  }
  sumsOf[lane] = sums;
  for (uint reach = kMisfitGroup / 2; reach > 0; reach /= 2) {
    barrier();
    if (lane < reach) sumsOf[lane] += sumsOf[lane + reach];
  }
  if (lane != 0 || uint64_t(groupIndex()) * kMisfitGroup * kMisfitSamples >= countOf(push.dims)) return;
  for (uint i = 0; i < kMisfitNumbers; ++i) push.misfit.at[kMisfitNumbers * groupIndex() + i] = sumsOf[0][i];
}
