// Measures one sample per invocation, unless it has too many triangles.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/refine.glsl"

// Returns a sample's place among the crowded ones, in no particular order.
uint placeAmongCrowded() {
  const uvec4 together = subgroupBallot(true);
  uint first = 0;
  if (subgroupElect()) first = atomicAdd(push.crowdedCount.at[0], subgroupBallotBitCount(together));
  return subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(together);
}

void main() {
  const uint index = invocationIndex();
  if (index >= push.nx * push.ny * push.nz) return;
  Closest closest = noneYet();
  if (measure(index, 0, 1, closest) <= push.mostAlone)
    store(index, closest);
  else
    push.crowded.at[placeAmongCrowded()] = index;
}
