// Applies the sign, clamps the distances to the band, and converts them to the mesh's units.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/sign.glsl"

void main() {
  const uint count = countOf(push.dims);
  const uint first = groupIndex() * kFinishedEach * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  if (first >= count) return;
  const bool isSigned = uint64_t(push.winding) != 0;
  float distances[kFinishedEach], windings[kFinishedEach];
  [[unroll]] for (uint n = 0; n < kFinishedEach; ++n) {
    const uint own = first + n * gl_WorkGroupSize.x, i = own < count ? own : first;  // Others write theirs.
    distances[n] = push.distance.at[i];
    windings[n] = isSigned ? abs(push.winding.at[i]) : 0.0;
  }
  [[unroll]] for (uint n = 0; n < kFinishedEach; ++n) {
    const uint i = first + n * gl_WorkGroupSize.x;
    if (i >= count) return;
    const float distance = isSigned ? signedBy(windings[n], distances[n], i) : distances[n];
    push.distance.at[i] = clamp(distance, -push.band, push.band) * push.scale;
  }
}
