// Finds the closest triangle of the samples of blocks with too much work: each sample by itself, so that no
// block keeps the device waiting.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/exact_distance.glsl"
#include "vulkan/stages/exact_distance_samples.glsl"

void main() {
  const uint index = push.firstGroup * gl_NumSubgroups + subgroupIndex();
  if (index >= push.heavy.at[0]) return;
  const uvec3 place = placeOf(push.heavy.at[1 + index / kBlockSamples], blocksAlong(push.side));
  const Block block = blockAt(place);
  const uvec3 at = samplePlace(block, index % kBlockSamples);
  if (any(greaterThanEqual(at, block.high))) return;
  // A little more than the distance so far, so that its own triangle is found again.
  const float distance = push.distance.at[gridIndex(at)];
  Closest closest = Closest(1.000001 * distance * distance, kNoneClosest);
  findClosestOfList(at, listAbove(place), closest);
  const bool isLeft = isTooMuchWork();
  if (lane() != 0) return;
  if (closest.triangle != kNoneClosest) writeSample(at, closest);
  if (isLeft) push.left.at[1 + atomicAdd(push.left.at[0], 1)] = gridIndex(at);
}
