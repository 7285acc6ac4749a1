// The triangle closest to the centre of each large block, and the nodes that may hold the closest triangle of some
// sample in it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel.glsl"
#include "subgroups.glsl"
#include "exact_distance.glsl"

// A node stays whole if its radius is at most so many cells.
const float kWide = 4;

// Writes the nodes to the list and returns how many they are. Where they would be too many, nodes stay whole.
uint listNodes(Block block, Corners corners, uint list) {
  uint listed = 0, size = 1;
  if (lane() == 0) stackNodes[onStack(0)] = 0;
  shareWithSubgroup();
  while (size > 0) {
    const uint room = (kListNodes - listed - size) / (kArity - 1);
    const uint taken = min(min(size, room), max(gl_SubgroupSize / kArity, 1));
    if (taken == 0 || push.firstLeaf == 0) break;
    size -= taken;
    const uint parent = stackNodes[onStack(size + lane() / kArity)];
    const bool isTaken = lane() / kArity < taken;
    shareWithSubgroup();
    for (uint child = lane() % kArity; child < kArity; child += gl_SubgroupSize) {
      const uint node = firstChildOf(parent) + child;
      bool survives = false, isWhole = false;
      if (isTaken) {
        const Disc disc = readDisc(push.discs, node);
        survives = disc.radius >= 0 && mayWin(tangentOf(disc, block.centre), block, corners);
        isWhole = isLeaf(node) || disc.radius <= kWide;
      }
      const uvec4 whole = subgroupBallot(survives && isWhole), open = subgroupBallot(survives && !isWhole);
      if (survives && isWhole) push.lists.at[list + listed + subgroupBallotExclusiveBitCount(whole)] = node;
      if (survives && !isWhole) stackNodes[onStack(size + subgroupBallotExclusiveBitCount(open))] = node;
      listed += subgroupBallotBitCount(whole);
      size += subgroupBallotBitCount(open);
      shareWithSubgroup();
    }
  }
  for (uint i = lane(); i < size; i += gl_SubgroupSize) push.lists.at[list + listed + i] = stackNodes[onStack(i)];
  return listed + size;
}

void main() {
  const uvec3 blocks = blocksAlong(kLargeSide);
  const uint index = subgroupIndex();
  if (index >= blocks.x * blocks.y * blocks.z) return;
  const Block block = blockAt(placeOf(index, blocks), kLargeSide);
  const float reach = 1.000001 * (push.band + length(block.reach));
  Closest closest = Closest(push.band > 0 ? reach * reach : kInfinity, kNoTriangle);
  if (lane() == 0) {
    stackNodes[onStack(0)] = 0;
    stackBounds[onStack(0)] = 0;
  }
  shareWithSubgroup();
  findClosest(block.centre, 1, closest);
  if (closest.triangle == kNoTriangle && isTooMuchWork()) closest.triangle = 0;
  uint count = 0;
  if (closest.triangle != kNoTriangle)
    count = listNodes(block, measureCorners(closest.triangle, block), index * kListWords + 2);
  if (lane() != 0) return;
  push.lists.at[index * kListWords] = count;
  push.lists.at[index * kListWords + 1] = closest.triangle;
}
