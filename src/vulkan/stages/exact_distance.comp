// Finds the closest triangle of every sample, a 4x4x4 block at a time, from the list of the block above.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/exact_distance.glsl"
#include "vulkan/stages/exact_distance_samples.glsl"

// Devices that only mask branches run loops without iterations faster than code under a condition. Hence
// `end` below, and no measuring within the loop that finds what to measure.

const uint kMostWaiting = 128;  // At least the largest subgroup.
// Leaves with at most this radius, in cells, wait as a whole, to be opened in the octants where they may win: each of
// their triangles matters to a few samples only.
const float kWholeLeaf = 1.5;
const uint kLeafBit = 0x80000000u;  // Marks leaves among what waits.
// Up to this many triangles are measured for all samples at once. Of more, octants of the block measure only
// those that may win there.
const uint kFewTriangles = 32;

// Triangles and leaves that wait to be measured, with planes below the distances to them: gradients, and values at
// the block's centre. Then what seems closest to each octant.
shared uint waiting[kMaxSubgroups * kMostWaiting];
shared vec4 planes[kMaxSubgroups * kMostWaiting];
shared uint nearestWaiting[kMaxSubgroups * 8];
uint waitingCount = 0;
bool hasLeaves = false;  // Whether this lane queued one; in octants, whether any lane did.

uint waitingAt(uint place) {
  return gl_SubgroupID * kMostWaiting + place;
}

// Triangles that may win in an octant, then leaves, then the limits of all samples lie where searches have the stack's
// bounds.
const uint kLimits = 2 * kMostWaiting;

uint forOctant(uint place) {
  return onStack(place);
}

// Measures a few triangles, two samples at once for each triangle read.
void measureTogether(Block block, uint count) {
  const uint end = count > 0 ? kBlockSamples : 0;
  for (uint s = lane(); s < end; s += 2 * gl_SubgroupSize) {
    const uint other = min(s + gl_SubgroupSize, kBlockSamples - 1);
    const vec3 p = samplePlace(block, s), q = samplePlace(block, other);
    Closest atP = readSample(s), atQ = readSample(other);
    for (uint i = 0; i < count; ++i) {
      const uint index = waiting[waitingAt(i)];
      const Triangle t = readTriangle(push.frames, index);
      const float toP = squaredDistance(t, p), toQ = squaredDistance(t, q);
      if (toP < atP.squared) atP = Closest(toP, index);
      if (toQ < atQ.squared) atQ = Closest(toQ, index);
    }
    keepSample(s, atP);
    if (s + gl_SubgroupSize < kBlockSamples) keepSample(other, atQ);
    work += count + 1;
  }
}

// An octant of a block, where its samples begin, and its centre as seen from the block's.
struct Octant {
  Block block;
  uvec3 first;
  vec3 offset;
};

Tangent waitingTangent(uint place, Octant octant) {
  const vec4 plane = planes[waitingAt(place)];
  return Tangent(plane.w + dot(plane.xyz, octant.offset), plane.xyz);
}

uvec3 cornerOf(uint k) {
  return uvec3(k, k >> 1, k >> 2) & 1;
}

uint octantSample(Octant octant, uvec3 at) {
  const uvec3 place = octant.first + at;
  return (place.z * kBlockSide + place.y) * kBlockSide + place.x;
}

// Measures the triangles of an octant. Several lanes share those of each sample.
void measureOctant(Block block, Octant octant, uint count) {
  const uint shares = max(gl_SubgroupSize >> 3, 1);
  for (uint k = lane() & 7; k < 8; k += gl_SubgroupSize) {
    const uint s = octantSample(octant, cornerOf(k));
    const vec3 p = samplePlace(block, s);
    const Closest before = readSample(s);
    shareWithSubgroup();
    Closest closest = before;
    for (uint i = lane() >> 3; i < count; i += shares) {
      const uint index = stackBounds[forOctant(i)];
      const float squared = squaredDistance(readTriangle(push.frames, index), p);
      if (squared < closest.squared) closest = Closest(squared, index);
    }
    takeClosestOfLanes(s, lane() < 8, before, closest);
    work += (count >> findMSB(shares)) + 2;
  }
}

// Octants at the grid's end may reach beyond it.
Octant octantOf(Block block, uint o) {
  const uvec3 first = 2 * cornerOf(o), low = block.low + first;
  const vec3 centre = vec3(low) + 0.5;
  return Octant(Block(low, low + 2, centre, vec3(0.5)), first, centre - block.centre);
}

// Bounds of four octants, rounded down so that the place fits below.
uvec4 keysOf(vec4 bounds, uint place) {
  return floatBitsToUint(max(bounds, 0)) & ~(kMostWaiting - 1) | place;
}

// Finds what may come closest to each octant's centre, which is one cell from the block's along each axis.
void findNearest() {
  uvec4 low = uvec4(~0u), high = low;
  for (uint place = lane(); place < waitingCount; place += gl_SubgroupSize) {
    const vec4 plane = planes[waitingAt(place)], across = acrossOf(plane.xyz);
    low = min(low, keysOf(plane.w - plane.z + across, place));
    high = min(high, keysOf(plane.w + plane.z + across, place));
  }
  low = subgroupMin(low);
  high = subgroupMin(high);
  for (uint o = lane(); o < 8; o += gl_SubgroupSize)
    nearestWaiting[gl_SubgroupID * 8 + o] =
        waiting[waitingAt((o < 4 ? low : high)[o & 3] & kMostWaiting - 1)];
  work += 8;
  shareWithSubgroup();
}

// Measures for each sample what may come closest to its octant's centre. The distance so far is its limit.
void measureNearest(Block block) {
  for (uint s = lane(); s < kBlockSamples; s += gl_SubgroupSize) {
    const vec3 p = samplePlace(block, s);
    const uint o = s >> 1 & 1 | s >> 2 & 2 | s >> 3 & 4, k = s & 1 | s >> 1 & 2 | s >> 2 & 4;
    const uint entry = nearestWaiting[gl_SubgroupID * 8 + o];
    const bool isWhole = (entry & kLeafBit) != 0;
    const uint first = isWhole ? firstTriangleOf(entry & ~kLeafBit) : entry, end = first + (isWhole ? kTreeArity : 1);
    Closest closest = readSample(s);
    for (uint triangle = first; triangle < end; ++triangle) {
      const float squared = squaredDistance(readTriangle(push.frames, triangle), p);
      if (squared < closest.squared) closest = Closest(squared, triangle);
    }
    keepSample(s, closest);
    stackBounds[forOctant(kLimits + 8 * o + k)] = floatBitsToUint(limitOf(closest.squared));
    work += kTreeArity;
  }
  shareWithSubgroup();
}

// Returns the limits of an octant's samples.
Corners octantLimits(uint o) {
  const uint first = forOctant(kLimits + 8 * o);
  return Corners(uintBitsToFloat(uvec4(stackBounds[first], stackBounds[first + 1], stackBounds[first + 2],
                                       stackBounds[first + 3])),
                 uintBitsToFloat(uvec4(stackBounds[first + 4], stackBounds[first + 5], stackBounds[first + 6],
                                       stackBounds[first + 7])));
}

// Lists each lane's triangle or leaf for the octant, from place `first` on, if it may win.
void listForOctant(bool mayWin, uint entry, uint first, inout uint count) {
  const uvec4 all = subgroupBallot(mayWin);
  if (mayWin) stackBounds[forOctant(first + count + subgroupBallotExclusiveBitCount(all))] = entry;
  count += subgroupBallotBitCount(all);
}

// Lists what waits and may win in the octant.
void listOctant(Octant octant, Corners corners, inout uint count, inout uint leaves) {
  uint offered = 0;
  for (uint first = 0; first < waitingCount; first += gl_SubgroupSize) {
    const uint place = min(first + lane(), waitingCount - 1), entry = waiting[waitingAt(place)];
    const bool survives =
        first + lane() < waitingCount && mayWin(waitingTangent(place, octant), octant.block, corners);
    const bool isWhole = (entry & kLeafBit) != 0;
    listForOctant(survives && !isWhole, entry, 0, count);
    if (hasLeaves) listForOctant(survives && isWhole, entry & ~kLeafBit, kMostWaiting, offered);
    work += 2;
  }
  shareWithSubgroup();
  for (uint first = 0; first < offered; first += gl_SubgroupSize) {  // As seen from the octant's centre, fewer may win.
    const uint leaf = stackBounds[forOctant(kMostWaiting + min(first + lane(), offered - 1))];
    const Tangent t = tangentOf(readDisc(push.discs, leaf), octant.block.centre);
    shareWithSubgroup();
    listForOctant(first + lane() < offered && mayWin(t, octant.block, corners), leaf, kMostWaiting, leaves);
    work += 2;
  }
  shareWithSubgroup();
}

// Lists the triangles of some leaves that may win in the octant, while there is room.
void openLeaves(Octant octant, Corners corners, inout uint leaves, inout uint count) {
  while (leaves > 0 && count + max(gl_SubgroupSize, kTreeArity) <= kMostWaiting) {
    const uint taken = min(leaves, max(gl_SubgroupSize >> kArityBits, 1));
    leaves -= taken;
    const uint first = firstTriangleOf(stackBounds[forOctant(kMostWaiting + leaves + min(parentOfLane(), taken - 1))]);
    for (uint child = childOfLane(); child < kTreeArity; child += gl_SubgroupSize) {
      const Tangent t = tangentOf(readTriangle(push.frames, first + child), octant.block.centre);
      listForOctant(parentOfLane() < taken && mayWin(t, octant.block, corners), first + child, 0, count);
    }
    work += 3;
  }
  shareWithSubgroup();
}

// Measures what waits, an octant at a time.
void measureOctants(Block block) {
  findNearest();
  measureNearest(block);
  for (uint o = 0; o < 8; ++o) {
    if (any(greaterThanEqual(block.low + 2 * cornerOf(o), block.high))) continue;
    const Octant octant = octantOf(block, o);
    const Corners corners = octantLimits(o);
    uint count = 0, leaves = 0;
    listOctant(octant, corners, count, leaves);
    do {
      openLeaves(octant, corners, leaves, count);
      measureOctant(block, octant, count);
      count = 0;
    } while (leaves > 0);
  }
}

void measureWaiting(Block block) {
  hasLeaves = subgroupBallotBitCount(subgroupBallot(hasLeaves)) > 0;
  const bool areFew = waitingCount <= kFewTriangles && !hasLeaves;
  measureTogether(block, areFew ? waitingCount : 0);
  if (!areFew) measureOctants(block);
  waitingCount = 0;
  hasLeaves = false;
  shareWithSubgroup();
}

bool hasRoom() {
  return waitingCount + max(gl_SubgroupSize, kTreeArity) <= kMostWaiting;
}

// Queues each lane's triangle or small leaf if it may win. Pushes other nodes that may win on the stack.
void offer(Block block, Corners corners, bool isTriangle, bool isNode, uint index, inout uint size) {
  Tangent t = Tangent(kLargestFloat, vec3(0));
  bool isWhole = false;
  if (isTriangle) t = tangentOf(readTriangle(push.frames, index), block.centre);
  if (isNode) {
    const Disc disc = readDisc(push.discs, index);
    if (disc.radius >= 0) t = tangentOf(disc, block.centre);
    isWhole = isLeaf(index) && disc.radius <= kWholeLeaf;
  }
  const bool survives = mayWin(t, block, corners), waits = survives && (isTriangle || isWhole);
  const uvec4 waiters = subgroupBallot(waits), open = subgroupBallot(survives && !waits);
  if (waits) {
    const uint place = waitingAt(waitingCount + subgroupBallotExclusiveBitCount(waiters));
    waiting[place] = isWhole ? index | kLeafBit : index;
    planes[place] = vec4(t.g, t.d);
  } else if (survives) {
    stackNodes[onStack(size + subgroupBallotExclusiveBitCount(open))] = index;
  }
  waitingCount += subgroupBallotBitCount(waiters);
  size += subgroupBallotBitCount(open);
  hasLeaves = hasLeaves || survives && isWhole;
}

// Takes nodes from the list, then from the stack, until the queues might overflow.
void fillWaiting(Block block, Corners corners, uint dominating, List list, inout uint next, inout uint size) {
  while ((next < list.count || size > 0) && hasRoom() && !isTooMuchWork()) {
    const bool isFromList = next < list.count;
    const uint taken = isFromList ? 0 : min(size, openable(size));
    size -= taken;
    const uint parent = parentAbove(size), listed = next + lane();
    const bool isTaken = parentOfLane() < taken, hasTriangles = isTaken && isLeaf(parent);
    shareWithSubgroup();
    for (uint child = childOfLane(); child < kTreeArity; child += gl_SubgroupSize) {
      const uint below = (hasTriangles ? firstTriangleOf(parent) : firstChildOf(parent)) + child;
      const bool isListed = isFromList && listed < list.count && child == childOfLane();
      offer(block, corners, hasTriangles && below != dominating, isListed || isTaken && !hasTriangles,
            isFromList ? listedNode(list, listed) : below, size);
    }
    shareWithSubgroup();
    if (isFromList) next += gl_SubgroupSize;
    work += 4;
  }
}

// Measures all triangles that may be closest to some sample.
void measureList(Block block, Corners corners, uint dominating, List list) {
  uint next = 0, size = 0;
  do {
    fillWaiting(block, corners, dominating, list, next, size);
    measureWaiting(block);
  } while ((next < list.count || size > 0) && !isTooMuchWork());
}

void measureSamples(Block block, uint dominating, List list) {
  const Triangle t = readTriangle(push.frames, dominating);
  for (uint s = lane(); s < kBlockSamples; s += gl_SubgroupSize)
    keepSample(s, Closest(squaredDistance(t, samplePlace(block, s)), dominating));
  measureList(block, measureCorners(dominating, block), dominating, list);
}

void main() {
  const uvec3 blocks = blocksAlong(push.side);
  const uint index = subgroupIndex();
  if (index >= countOf(blocks)) return;
  const uvec3 place = placeOf(index, blocks);
  const Block block = blockAt(place);
  const List list = listAbove(place);
  const uint closest = list.hint == kNoneClosest ? kNoneClosest : findCentre(block, list);
  if (closest != kNoneClosest) measureSamples(block, closest, list);
  for (uint s = lane(); s < kBlockSamples; s += gl_SubgroupSize) {
    const uvec3 at = samplePlace(block, s);
    if (any(greaterThanEqual(at, block.high))) continue;
    const Closest found = closest == kNoneClosest ? Closest(0, kNoneClosest) : readSample(s);
    writeSample(at, found);
  }
  if (isTooMuchWork() && lane() == 0)
    push.heavy.at[1 + atomicAdd(push.heavy.at[0], kBlockSamples) / kBlockSamples] = index;
}
