// Measures one sample per invocation, unless it has too many triangles.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/refine.glsl"

void main() {
  const uint index = invocationIndex();
  if (index >= countOf(push.dims)) return;
  Closest closest = noneYet();
  if (measure(index, 0, 1, closest) <= push.mostAlone)
    store(index, closest);
  else  // In no particular order. No subgroup operation: invocations may arrive here one by one.
    push.crowded.at[atomicAdd(push.crowdedCount.at[0], 1)] = index;
}
