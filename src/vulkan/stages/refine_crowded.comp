// Measures one sample per group.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/refine.glsl"

shared Closest closestOf[kRefineGroup / 4];  // Per subgroup; none has fewer than four invocations.

void main() {
  const uint crowded = push.firstGroup + groupIndex();
  if (crowded >= push.crowdedCount.at[0]) return;
  const uint index = push.crowded.at[crowded];
  Closest closest = noneYet();
  measure(index, laneIndex(), kRefineGroup, closest);
  const float squared = subgroupMinSquare(closest.squared);
  const uint triangle = subgroupMin(closest.squared == squared ? closest.triangle : 0xffffffffu);
  if (subgroupElect()) closestOf[gl_SubgroupID] = Closest(squared, triangle);
  barrier();
  if (gl_LocalInvocationIndex > 0) return;
  closest = closestOf[0];
  for (uint i = 1; i < gl_NumSubgroups; ++i) take(closest, closestOf[i].squared, closestOf[i].triangle);
  store(index, closest);
}
