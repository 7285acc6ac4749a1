// Measures the triangles of some leaves for samples that are left, unless the leaves lie too far away.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/exact_distance.glsl"
#include "vulkan/stages/exact_distance_samples.glsl"

void measureLeaf(uint leaf, vec3 p, inout Closest closest) {
  for (uint child = lane() % kTreeArity; child < kTreeArity; child += gl_SubgroupSize) {
    const uint triangle = leaf * kTreeArity + child;
    takeClosest(closest, squaredDistance(readTriangle(push.frames, triangle), p), triangle);
  }
}

void main() {
  const uint index = push.firstGroup * gl_NumSubgroups + subgroupIndex();
  if (index >= push.left.at[0]) return;
  const uint s = push.left.at[1 + index];
  const uvec3 at = placeOf(s, push.dims);
  Closest closest = Closest(push.distance.at[s] * push.distance.at[s], kNoneClosest);
  const uint end = min(push.restLeaf + kRestLeaves, push.leafCount);
  for (uint first = push.restLeaf; first < end; first += gl_SubgroupSize) {
    const Disc disc = readDisc(push.discs, push.firstLeaf + min(first + lane(), end - 1));
    uvec4 wanted = subgroupBallot(first + lane() < end && squaredDistance(disc, at) < closest.squared);
    while (wanted != uvec4(0)) {
      const uint bit = subgroupBallotFindLSB(wanted);
      wanted[bit / 32] &= wanted[bit / 32] - 1;
      measureLeaf(first + bit, at, closest);
    }
  }
  if (lane() == 0 && closest.triangle != kNoneClosest) writeSample(at, closest);
}
