// Measures the triangles of some leaves for unfinished blocks, unless the leaves lie too far away.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/exact_distance.glsl"
#include "vulkan/stages/exact_distance_samples.glsl"

// Returns the largest squared distance of all samples of the block.
float farthest() {
  float largest = 0;
  for (uint s = lane(); s < kBlockSamples; s += gl_SubgroupSize) largest = max(largest, readSample(s).squared);
  return subgroupMax(largest);
}

void measureLeaf(Block block, uint firstTriangle) {
  for (uint s = lane(); s < kBlockSamples; s += gl_SubgroupSize) {
    Closest closest = readSample(s);
    const vec3 p = samplePlace(block, s);
    [[unroll]] for (uint i = 0; i < kTreeArity; ++i) {
      const float squared = squaredDistance(readTriangle(push.frames, firstTriangle + i), p);
      if (squared < closest.squared) closest = Closest(squared, firstTriangle + i);
    }
    keepSample(s, closest);
  }
}

void main() {
  const uint index = subgroupIndex();
  if (index >= push.unfinished.at[0]) return;
  const Block block = blockAt(placeOf(push.unfinished.at[1 + index], blocksAlong(push.side)));
  for (uint s = lane(); s < kBlockSamples; s += gl_SubgroupSize) {
    const uvec3 at = samplePlace(block, s);
    const float distance = all(lessThan(at, block.high)) ? push.distance.at[gridIndex(at)] : 0;
    keepSample(s, Closest(distance * distance, kNoneClosest));
  }
  const uint end = min(push.restLeaf + kRestLeaves, push.leafCount);
  for (uint first = push.restLeaf; first < end; first += gl_SubgroupSize) {
    const Disc disc = readDisc(push.discs, push.firstLeaf + min(first + lane(), end - 1));
    const float bound = sqrt(squaredDistance(disc, block.centre)) - 1.000001 * length(block.reach);
    const float limit = farthest();  // Here all lanes take part.
    uvec4 wanted = subgroupBallot(first + lane() < end && (bound < 0 || bound * bound < limit));
    while (wanted != uvec4(0)) {
      const uint bit = subgroupBallotFindLSB(wanted);
      wanted[bit / 32] &= wanted[bit / 32] - 1;
      measureLeaf(block, (first + bit) * kTreeArity);
    }
  }
  for (uint s = lane(); s < kBlockSamples; s += gl_SubgroupSize)
    if (readSample(s).triangle != kNoneClosest) writeSample(samplePlace(block, s), readSample(s));
}
