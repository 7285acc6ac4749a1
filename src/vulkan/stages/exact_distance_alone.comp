// Finds the closest triangle of the samples of blocks with too much work, or of all blocks: each sample by itself, so
// that no block keeps the device waiting.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/exact_distance.glsl"
#include "vulkan/stages/exact_distance_samples.glsl"

bool areAllAlone() {
  return uint64_t(push.heavy) == 0;
}

// Returns what is known of a sample before the search. Limits are a little more than the distance so far or the band,
// so that a triangle there is found.
Closest startOf(uvec3 at, List list) {
  const bool isFirst = areAllAlone() && push.isAddition == 0;
  const float limit = isFirst ? push.band : push.distance.at[indexOf(at, push.dims)];
  const Closest none = Closest(isFirst && limit == 0 ? kLargestFloat : 1.000001 * limit * limit, kNoneClosest);
  if (!areAllAlone()) return none;
  const float hinted = squaredDistance(readTriangle(push.frames, list.hint), vec3(at));
  return hinted < none.squared ? Closest(hinted, list.hint) : none;
}

void main() {
  const uint index = push.firstGroup * gl_NumSubgroups + subgroupIndex();
  const uvec3 blocks = blocksAlong(push.side);
  if (index >= (areAllAlone() ? countOf(blocks) * kBlockSamples : push.heavy.at[0])) return;
  const uint blockIndex = index / kBlockSamples;
  const uvec3 place = placeOf(areAllAlone() ? blockIndex : push.heavy.at[1 + blockIndex], blocks);
  const Block block = blockAt(place);
  const uvec3 at = samplePlace(block, index % kBlockSamples);
  if (any(greaterThanEqual(at, block.high))) return;
  const List list = listAbove(place);
  Closest closest = Closest(0, kNoneClosest);  // The band does not reach this block.
  if (list.hint != kNoneClosest) {
    closest = startOf(at, list);
    findClosestOfList(at, list, closest);
  }
  const bool isLeft = isTooMuchWork();
  if (lane() != 0) return;
  if (closest.triangle != kNoneClosest || areAllAlone()) writeSample(at, closest);
  if (isLeft) push.left.at[1 + atomicAdd(push.left.at[0], 1)] = indexOf(at, push.dims);
}
