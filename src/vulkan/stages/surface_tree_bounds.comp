// Computes the bounds of all vertices by integer atomics: the result is the same in any order.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/surface_tree.glsl"
#include "vulkan/primitives/ordered_float.glsl"

void main() {
  const uint first = groupIndex() * gl_WorkGroupSize.x * kVerticesEach + laneIndex();
  vec3 low = vec3(kLargestFloat), high = -low;
  [[unroll]] for (uint i = 0; i < kVerticesEach; ++i) {
    const uint vertex = first + i * gl_WorkGroupSize.x;
    if (vertex >= push.vertexCount) break;
    const vec3 v = vectorAt(push.vertices, vertex);
    low = min(low, v);
    high = max(high, v);
  }
  low = subgroupMin(low);
  high = subgroupMax(high);
  if (!subgroupElect()) return;
  [[unroll]] for (uint axis = 0; axis < 3; ++axis) {
    // The complement turns the maximum into a minimum, so all six words have the same initial value.
    atomicMin(push.bounds.at[axis], toOrdered(low[axis]));
    atomicMin(push.bounds.at[3 + axis], ~toOrdered(high[axis]));
  }
}
