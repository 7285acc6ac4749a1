// Replaces the winding numbers of doubtful samples by those of the triangles themselves.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_dipoles.glsl"
#include "vulkan/stages/winding_number.glsl"

shared uint doubtful[kDoubtsSamples];
shared uint doubtfulCount;

void settle(uint index) {
  const uint row = index / push.gridX;
  const vec3 p = vec3(index % push.gridX, row % push.gridY, row / push.gridY);
  for (uint look = 0; look < kLooks; ++look) {
    bool whole;
    const float w = windingNumber(p, kDistant[look], whole);
    if (!whole) return;  // Keeps the last value.
    push.winding.at[index] = w;
    if (abs(abs(w) - push.threshold) >= kClose[look]) return;
  }
}

void main() {
  const uint first = groupIndex() * kDoubtsSamples;
  if (first >= sampleCount()) return;
  if (gl_LocalInvocationIndex == 0) doubtfulCount = 0;
  barrier();
  for (uint i = gl_LocalInvocationIndex; i < kDoubtsSamples; i += gl_WorkGroupSize.x)
    if (first + i < sampleCount() && isDoubtful(first + i)) doubtful[atomicAdd(doubtfulCount, 1)] = first + i;
  barrier();
  for (uint i = gl_LocalInvocationIndex; i < doubtfulCount; i += gl_WorkGroupSize.x) settle(doubtful[i]);
}
