// The closest triangle of every sample: a small block at a time, from the list of the large one around it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel.glsl"
#include "subgroups.glsl"
#include "exact_distance.glsl"
#include "exact_distance_samples.glsl"

const uint kTriangles = 128;  // At least the largest subgroup.

shared uint triangles[kMaxSubgroups * kTriangles];

// The triangles that wait to be measured.
uint waiting = 0;

uint ofTriangle(uint place) {
  return gl_SubgroupID * kTriangles + place;
}

// Measures all that wait, two samples at once for each that is read.
void measureTriangles(Block block) {
  for (uint s = lane(); s < kSamples; s += 2 * gl_SubgroupSize) {
    const uint other = min(s + gl_SubgroupSize, kSamples - 1), first = ofSample(s), second = ofSample(other);
    const vec3 p = samplePlace(block, s), q = samplePlace(block, other);
    Closest atP = Closest(sampleSquared[first], sampleTriangle[first]);
    Closest atQ = Closest(sampleSquared[second], sampleTriangle[second]);
    for (uint i = 0; i < waiting; ++i) {
      const uint index = triangles[ofTriangle(i)];
      const Triangle t = readTriangle(push.frames, index);
      const float toP = squaredDistance(t, p), toQ = squaredDistance(t, q);
      if (toP < atP.squared) atP = Closest(toP, index);
      if (toQ < atQ.squared) atQ = Closest(toQ, index);
    }
    sampleSquared[first] = atP.squared;
    sampleTriangle[first] = atP.triangle;
    if (s + gl_SubgroupSize < kSamples) {
      sampleSquared[second] = atQ.squared;
      sampleTriangle[second] = atQ.triangle;
    }
    work += waiting + 1;
  }
  waiting = 0;
  shareWithSubgroup();
}

void addTriangles(Block block, bool isWanted, uint triangle) {
  const uvec4 wanted = subgroupBallot(isWanted);
  const uint count = subgroupBallotBitCount(wanted);
  if (waiting + count > kTriangles) measureTriangles(block);
  if (isWanted) triangles[ofTriangle(waiting + subgroupBallotExclusiveBitCount(wanted))] = triangle;
  waiting += count;
  shareWithSubgroup();
}

// Measures all triangles below the nodes on the stack that may be closest to some sample.
void measureBelow(Block block, Corners corners, uint dominating, uint size) {
  while (size > 0 && !isTooMuchWork()) {
    const uint taken = min(size, openable(size));
    size -= taken;
    const uint parent = stackNodes[onStack(size + lane() / kArity)];
    const bool isTaken = lane() / kArity < taken, hasTriangles = isTaken && isLeaf(parent);
    shareWithSubgroup();
    for (uint child = lane() % kArity; child < kArity; child += gl_SubgroupSize) {
      const uint triangle = firstTriangleOf(parent) + child, node = firstChildOf(parent) + child;
      bool survives = false;
      if (hasTriangles) {
        survives = triangle != dominating &&
                   mayWin(tangentOf(readTriangle(push.frames, triangle), block.centre), block, corners);
      } else if (isTaken) {
        const Disc disc = readDisc(push.discs, node);
        survives = disc.radius >= 0 && mayWin(tangentOf(disc, block.centre), block, corners);
      }
      addTriangles(block, survives && hasTriangles, triangle);
      pushNodes(size, survives && !hasTriangles, node, 0);
    }
    work += 3;
  }
  measureTriangles(block);
}

// The closest triangle to the block's centre.
Closest findCentre(Block block, uint list, uint count) {
  const uint hint = push.lists.at[list + 1];
  Closest closest = Closest(squaredDistance(readTriangle(push.frames, hint), block.centre), hint);
  uint size = 0;
  for (uint first = 0; first < count; first += gl_SubgroupSize) {
    const bool isListed = first + lane() < count;
    const uint node = isListed ? push.lists.at[list + 2 + first + lane()] : 0;
    const float bound = squaredDistance(readDisc(push.discs, node), block.centre);
    pushNodes(size, isListed && bound < closest.squared, node, bound);
  }
  findClosest(block.centre, size, closest);
  return closest;
}

void measureSamples(Block block, uint dominating, uint list, uint count) {
  for (uint s = lane(); s < kSamples; s += gl_SubgroupSize) sampleSquared[ofSample(s)] = kInfinity;
  const Corners corners = measureCorners(dominating, block);
  if (lane() == 0) triangles[ofTriangle(0)] = dominating;
  waiting = 1;
  uint size = 0;
  for (uint first = 0; first < count; first += gl_SubgroupSize) {
    const bool isListed = first + lane() < count;
    const uint node = isListed ? push.lists.at[list + 2 + first + lane()] : 0;
    const bool survives = isListed && mayWin(tangentOf(readDisc(push.discs, node), block.centre), block, corners);
    pushNodes(size, survives, node, 0);
  }
  measureBelow(block, corners, dominating, size);
}

void main() {
  const uvec3 blocks = blocksAlong(kSmallSide);
  const uint index = subgroupIndex();
  if (index >= blocks.x * blocks.y * blocks.z) return;
  const uvec3 place = placeOf(index, blocks), above = place / (kLargeSide / kSmallSide);
  const uvec3 largeBlocks = blocksAlong(kLargeSide);
  const uint list = ((above.z * largeBlocks.y + above.y) * largeBlocks.x + above.x) * kListWords;
  const Block block = blockAt(place, kSmallSide);
  const uint count = push.lists.at[list];
  bool isFar = push.lists.at[list + 1] == kNoTriangle;
  if (!isFar) {
    const Closest closest = findCentre(block, list, count);
    isFar = push.band > 0 && sqrt(closest.squared) - 1.000001 * length(block.reach) > push.band;
    if (!isFar) measureSamples(block, closest.triangle, list, count);
  }
  for (uint s = lane(); s < kSamples; s += gl_SubgroupSize) {
    const uvec3 at = samplePlace(block, s);
    if (any(greaterThanEqual(at, block.high))) continue;
    if (isFar)
      writeSample(at, 0, kNoTriangle);
    else
      writeSample(at, sqrt(sampleSquared[ofSample(s)]), sampleTriangle[ofSample(s)]);
  }
  if (!isTooMuchWork() || lane() != 0) return;
  push.unfinished.at[1 + atomicAdd(push.unfinished.at[0], 1)] = index;
}
