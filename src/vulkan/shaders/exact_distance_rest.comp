// Small blocks that were too much work: measures the triangles of some of the leaves, unless these lie too far away.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel.glsl"
#include "subgroups.glsl"
#include "exact_distance.glsl"
#include "exact_distance_samples.glsl"

// The largest squared distance of all samples of the block.
float farthest() {
  float largest = -1;
  for (uint s = lane(); s < kSamples; s += gl_SubgroupSize) largest = max(largest, sampleSquared[ofSample(s)]);
  return subgroupMax(largest);
}

void measureLeaf(Block block, uint firstTriangle) {
  for (uint s = lane(); s < kSamples; s += gl_SubgroupSize) {
    Closest closest = Closest(sampleSquared[ofSample(s)], sampleTriangle[ofSample(s)]);
    const vec3 p = samplePlace(block, s);
    [[unroll]] for (uint i = 0; i < kArity; ++i) {
      const float squared = squaredDistance(readTriangle(push.frames, firstTriangle + i), p);
      if (squared < closest.squared) closest = Closest(squared, firstTriangle + i);
    }
    sampleSquared[ofSample(s)] = closest.squared;
    sampleTriangle[ofSample(s)] = closest.triangle;
  }
}

void main() {
  const uint index = subgroupIndex();
  if (index >= push.unfinished.at[0]) return;
  const Block block = blockAt(placeOf(push.unfinished.at[1 + index], blocksAlong(kSmallSide)), kSmallSide);
  for (uint s = lane(); s < kSamples; s += gl_SubgroupSize) {
    const uvec3 at = samplePlace(block, s);
    const bool isInside = all(lessThan(at, block.high));
    const float distance = isInside ? push.distance.at[gridIndex(at)] : 0;
    sampleSquared[ofSample(s)] = distance * distance;
    sampleTriangle[ofSample(s)] = kNoTriangle;
  }
  const uint end = min(push.restLeaf + kRestLeaves, push.leafCount);
  for (uint first = push.restLeaf; first < end; first += gl_SubgroupSize) {
    const float bound = sqrt(squaredDistance(readDisc(push.discs, push.firstLeaf + min(first + lane(), end - 1)),
                                             block.centre)) -
                        1.000001 * length(block.reach);
    const bool mayMatter = first + lane() < end && (bound < 0 || bound * bound < farthest());
    uvec4 leaves = subgroupBallot(mayMatter);
    while (any(notEqual(leaves, uvec4(0)))) {
      const uint bit = subgroupBallotFindLSB(leaves);
      leaves[bit / 32] &= leaves[bit / 32] - 1;
      measureLeaf(block, (first + bit) * kArity);
    }
  }
  for (uint s = lane(); s < kSamples; s += gl_SubgroupSize)
    if (sampleTriangle[ofSample(s)] != kNoTriangle)
      writeSample(samplePlace(block, s), sqrt(sampleSquared[ofSample(s)]), sampleTriangle[ofSample(s)]);
}
