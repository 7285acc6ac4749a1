// Finds the closest triangle of every sample, a 4x4x4 block at a time, from the list of the block above.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/exact_distance.glsl"
#include "vulkan/stages/exact_distance_samples.glsl"

// Devices that only mask branches run loops without iterations faster than code under a condition. Hence
// `end` below, and no measuring within the loop that finds what to measure.

const uint kMostWaiting = 128;  // At least the largest subgroup.
// Leaves with at most this radius, in cells, are measured as a whole, by the samples that they may be closest
// to. Their triangles are small compared with the spacing, and each leaf matters to a few samples only.
const float kWholeLeaf = 1.5;
// Up to this many triangles are measured for all samples at once. For more, octants of the block first drop
// those that cannot win there.
const uint kFewTriangles = 40;
// Leaves per bit mask: a sample marks those that may be closest to it before it measures them.
const uint kMaskBits = 32;

// Triangles and leaves waiting to be measured, and triangles of an octant.
shared uint triangles[kMaxSubgroups * kMostWaiting];
shared uint leaves[kMaxSubgroups * kMostWaiting];
shared uint octantTriangles[kMaxSubgroups * kMostWaiting];
uint triangleCount = 0;
uint leafCount = 0;

uint waitingAt(uint place) {
  return gl_SubgroupID * kMostWaiting + place;
}

void measureTriangle(uint index, vec3 p, inout Closest closest) {
  const float squared = squaredDistance(readTriangle(push.frames, index), p);
  if (squared < closest.squared) closest = Closest(squared, index);
}

// Measures a few triangles, two samples at once for each triangle read.
void measureTogether(Block block, uint count) {
  const uint end = count > 0 ? kBlockSamples : 0;
  for (uint s = lane(); s < end; s += 2 * gl_SubgroupSize) {
    const uint other = min(s + gl_SubgroupSize, kBlockSamples - 1);
    const vec3 p = samplePlace(block, s), q = samplePlace(block, other);
    Closest atP = readSample(s), atQ = readSample(other);
    for (uint i = 0; i < count; ++i) {
      const uint index = triangles[waitingAt(i)];
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

// Lists the waiting triangles that may win in an octant of the block, and returns their number.
uint listOctant(Block octant, uint dominating) {
  Closest closest = Closest(squaredDistance(readTriangle(push.frames, dominating), octant.centre), dominating);
  for (uint first = 0; first < triangleCount; first += gl_SubgroupSize) {
    const uint index = triangles[waitingAt(min(first + lane(), triangleCount - 1))];
    takeClosest(closest, squaredDistance(readTriangle(push.frames, index), octant.centre), index);
  }
  const Corners corners = measureCorners(closest.triangle, octant);
  uint count = 0;
  for (uint first = 0; first < triangleCount; first += gl_SubgroupSize) {
    const uint index = triangles[waitingAt(min(first + lane(), triangleCount - 1))];
    const Triangle t = readTriangle(push.frames, index);
    const bool survives = first + lane() < triangleCount &&
                          (index == closest.triangle || mayWin(tangentOf(t, octant.centre), octant, corners));
    const uvec4 surviving = subgroupBallot(survives);
    if (survives) octantTriangles[waitingAt(count + subgroupBallotExclusiveBitCount(surviving))] = index;
    count += subgroupBallotBitCount(surviving);
  }
  shareWithSubgroup();
  work += 2 * triangleCount / gl_SubgroupSize + 4;
  return count;
}

// Measures the triangles of an octant. Several lanes share those of each sample.
void measureOctant(Block block, uvec3 octant, uint count) {
  for (uint k = lane() % 8; k < 8; k += gl_SubgroupSize) {
    const uvec3 at = 2 * octant + placeOf(k, uvec3(2));
    const uint s = (at.z * kBlockSide + at.y) * kBlockSide + at.x;
    const vec3 p = samplePlace(block, s);
    const Closest before = readSample(s);
    shareWithSubgroup();
    Closest closest = before;
    for (uint i = lane() / 8; i < count; i += max(gl_SubgroupSize / 8, 1))
      measureTriangle(octantTriangles[waitingAt(i)], p, closest);
    takeClosestOfLanes(s, lane() < 8, before, closest);
    work += count + 2;
  }
}

// Measures all waiting triangles.
void measureTriangles(Block block, uint dominating) {
  shareWithSubgroup();
  const bool areFew = triangleCount <= kFewTriangles;
  measureTogether(block, areFew ? triangleCount : 0);
  for (uint o = areFew ? 8 : 0; o < 8; ++o) {
    const uvec3 octant = placeOf(o, uvec3(2)), low = block.low + 2 * octant, high = min(low + 2, block.high);
    if (any(greaterThanEqual(low, high))) continue;
    measureOctant(block, octant, listOctant(blockFrom(low, high), dominating));
  }
  triangleCount = 0;
  shareWithSubgroup();
}

void measureLeaf(uint place, vec3 p, inout Closest closest) {
  const uint first = firstTriangleOf(leaves[waitingAt(place)]);
  for (uint i = 0; i < kTreeArity; ++i) measureTriangle(first + i, p, closest);
}

float boundOfLeaf(uint place, vec3 p) {
  return squaredDistance(readDisc(push.discs, leaves[waitingAt(place)]), p);
}

// Returns the leaf that may come closest to a point, if any may come closer than the closest triangle so far.
uint nearestLeaf(vec3 p, Closest closest) {
  uint nearest = kMostWaiting;
  float least = closest.squared;
  for (uint i = 0; i < leafCount; ++i) {
    const float bound = boundOfLeaf(i, p);
    if (bound < least) nearest = i;
    least = min(least, bound);
  }
  return nearest;
}

// Measures the waiting leaves. Each sample first measures the leaf that may come closest, which nearly
// settles its distance, then those that still may come closer.
void measureLeaves(Block block) {
  shareWithSubgroup();
  const uint end = leafCount > 0 ? kBlockSamples : 0;
  for (uint s = lane(); s < end; s += gl_SubgroupSize) {
    const vec3 p = samplePlace(block, s);
    Closest closest = readSample(s);
    const uint nearest = nearestLeaf(p, closest);
    if (nearest < leafCount) measureLeaf(nearest, p, closest);
    for (uint first = 0; first < leafCount; first += kMaskBits) {
      uint wanted = 0;
      for (uint i = first; i < min(first + kMaskBits, leafCount); ++i)
        wanted |= uint(i != nearest && boundOfLeaf(i, p) < closest.squared) << (i - first);
      for (; wanted != 0; wanted &= wanted - 1) {
        measureLeaf(first + findLSB(wanted), p, closest);
        work += kTreeArity;
      }
    }
    keepSample(s, closest);
    work += 2 * leafCount + kTreeArity;
  }
  leafCount = 0;
  shareWithSubgroup();
}

bool hasRoom() {
  return max(triangleCount, leafCount) + max(gl_SubgroupSize, kTreeArity) <= kMostWaiting;
}

// Queues each lane's triangle for measuring if it may win.
void offerTriangles(Block block, Corners corners, bool isOffered, uint triangle) {
  const bool survives =
      isOffered && mayWin(tangentOf(readTriangle(push.frames, triangle), block.centre), block, corners);
  const uvec4 waits = subgroupBallot(survives);
  if (survives) triangles[waitingAt(triangleCount + subgroupBallotExclusiveBitCount(waits))] = triangle;
  triangleCount += subgroupBallotBitCount(waits);
}

// If it may win, queues each lane's node if it is a small leaf, else pushes it on the stack.
void offerNodes(Block block, Corners corners, bool isOffered, uint node, inout uint size) {
  bool survives = false, isWhole = false;
  if (isOffered) {
    const Disc disc = readDisc(push.discs, node);
    survives = disc.radius >= 0 && mayWin(tangentOf(disc, block.centre), block, corners);
    isWhole = isLeaf(node) && disc.radius <= kWholeLeaf;
  }
  const uvec4 waits = subgroupBallot(survives && isWhole);
  if (survives && isWhole) leaves[waitingAt(leafCount + subgroupBallotExclusiveBitCount(waits))] = node;
  leafCount += subgroupBallotBitCount(waits);
  pushNodes(size, survives && !isWhole, node, 0);
}

// Takes nodes from the list, then from the stack, until the queues might overflow.
void fillWaiting(Block block, Corners corners, uint dominating, List list, inout uint next, inout uint size) {
  while ((next < list.count || size > 0) && hasRoom() && !isTooMuchWork()) {
    const bool isFromList = next < list.count;
    const uint taken = isFromList ? 0 : min(size, openable(size));
    size -= taken;
    const uint parent = parentAbove(size);
    const bool isTaken = lane() / kTreeArity < taken, hasTriangles = isTaken && isLeaf(parent);
    const bool isListed = isFromList && next + lane() < list.count;
    shareWithSubgroup();
    for (uint child = lane() % kTreeArity; child < kTreeArity; child += gl_SubgroupSize) {
      const uint triangle = firstTriangleOf(parent) + child;
      offerTriangles(block, corners, hasTriangles && triangle != dominating, triangle);
      const uint node = isListed ? listedNode(list, next + lane()) : firstChildOf(parent) + child;
      const bool isFirst = child == lane() % kTreeArity;
      offerNodes(block, corners, isListed ? isFirst : isTaken && !hasTriangles, node, size);
    }
    if (isFromList) next += gl_SubgroupSize;
    work += 4;
  }
}

// Measures all triangles that may be closest to some sample.
void measureList(Block block, Corners corners, uint dominating, List list) {
  uint next = 0, size = 0;
  do {
    fillWaiting(block, corners, dominating, list, next, size);
    measureTriangles(block, dominating);
    measureLeaves(block);
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
  if (index >= blocks.x * blocks.y * blocks.z) return;
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
