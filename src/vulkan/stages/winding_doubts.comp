// Finds the largest change of the winding numbers along a crossed edge, apart from its crossings. GPU twin of
// cpu/sign/winding_doubts.cpp.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/ray_map.glsl"
#include "vulkan/stages/winding_doubts_push.h"

layout(push_constant, scalar) uniform Push { WindingDoubtsPush push; };

// Returns the change along the edge from a sample to the next one along an axis, or 0 if it is not crossed.
float changeAlong(Ints rays, uint axis, ivec3 s, uint index, uint stride) {
  const int count = crossingsOfEdge(rays, axis, ivec3(push.dims), s);
  return count == 0 ? 0 : abs(float(count) - (push.winding.at[index] - push.winding.at[index + stride]));
}

void main() {
  if (push.disagreeing.at[0] == 0) return;
  const uint plane = push.dims.x * push.dims.y, samples = plane * push.dims.z;
  const uint first = groupIndex() * kWindingDoubtsSamples * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  float largest = 0;
  for (uint n = 0; n < kWindingDoubtsSamples; ++n) {
    const uint i = first + n * gl_WorkGroupSize.x;
    if (i >= samples) break;
    const ivec3 s = ivec3(placeOf(i, push.dims));
    largest = max(largest, max(changeAlong(push.rays[0], 0, s, i, 1),
                               max(changeAlong(push.rays[1], 1, s, i, push.dims.x),
                                   changeAlong(push.rays[2], 2, s, i, plane))));
  }
  // The bits of floats that are not negative have the order of their values.
  const uint bits = floatBitsToUint(subgroupMax(largest));
  if (bits != 0 && subgroupElect()) atomicMax(push.change.at[0], bits);
}
