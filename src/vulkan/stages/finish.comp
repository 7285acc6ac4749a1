// Clamps the distances to the band and converts them to the mesh's units.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/finish_push.h"

layout(push_constant, scalar) uniform Push { FinishPush push; };

void main() {
  const uint first = groupIndex() * kFinishedEach * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  float distances[kFinishedEach];
  [[unroll]] for (uint n = 0; n < kFinishedEach; ++n)
    distances[n] = push.distance.at[min(first + n * gl_WorkGroupSize.x, push.count - 1)];
  [[unroll]] for (uint n = 0; n < kFinishedEach; ++n) {
    const uint i = first + n * gl_WorkGroupSize.x;
    if (i < push.count) push.distance.at[i] = clamp(distances[n], -push.band, push.band) * push.scale;
  }
}
