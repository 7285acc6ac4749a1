// Krayer & Müller 2019, §3.5, end: applies the winding number's threshold and rates the confidence
// (cpu/sign/sign.h).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/ray_map.glsl"
#include "vulkan/stages/sign_push.h"

layout(push_constant, scalar) uniform Push { SignPush push; };

// Returns how many of the two rays along an axis give the same sign, each on its own.
uint votes(Ints rays, uint axis, ivec3 s, ivec3 dims, bool inside) {
  ivec3 beforeAll = s;
  beforeAll[axis] = -1;
  const int ray = rayFrom(rays, axis, dims, s);
  const int back = ray - rayFrom(rays, axis, dims, beforeAll);
  return uint((abs(float(ray)) > push.threshold) == inside) + uint((abs(float(back)) > push.threshold) == inside);
}

float rate(float w, bool inside, ivec3 s, ivec3 dims) {
  const float below = 1.0 / push.threshold;
  const float above = push.threshold < 1.0 ? 1.0 / (1.0 - push.threshold) : below;
  const float margin = inside ? (w - push.threshold) * above : (push.threshold - w) * below;
  const uint agreeing = votes(push.rays[0], 0, s, dims, inside) + votes(push.rays[1], 1, s, dims, inside) +
                        votes(push.rays[2], 2, s, dims, inside);
  return min(margin, 1.0) * (6.0 + float(agreeing)) / 12.0;
}

void writeConfidence(uint i, float w, bool inside) {
  const uint row = i / push.gridX;
  const ivec3 dims = ivec3(push.gridX, push.gridY, push.gridZ);
  push.confidence.at[i] = rate(w, inside, ivec3(i % push.gridX, row % push.gridY, row / push.gridY), dims);
}

void main() {
  const uint count = push.gridX * push.gridY * push.gridZ;
  const uint first = groupIndex() * kSignedEach * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  float distances[kSignedEach], windings[kSignedEach];
  [[unroll]] for (uint n = 0; n < kSignedEach; ++n) {
    const uint i = min(first + n * gl_WorkGroupSize.x, count - 1);
    distances[n] = push.distance.at[i];
    windings[n] = abs(push.winding.at[i]);
  }
  [[unroll]] for (uint n = 0; n < kSignedEach; ++n) {
    const uint i = first + n * gl_WorkGroupSize.x;
    if (i >= count) return;
    const bool inside = windings[n] > push.threshold;
    if (inside != (push.isInverted != 0)) push.distance.at[i] = -distances[n];
    if (uint64_t(push.confidence) != 0) writeConfidence(i, windings[n], inside);
  }
}
