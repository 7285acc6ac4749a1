// Finds for each block the triangle closest to its centre, and lists nodes with every triangle that may be
// closest to some sample in it. The nodes come from the list of the block above. Also empties the lists of heavy
// blocks and of samples that are left.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/exact_distance.glsl"

// Nodes with at most this radius, as a share of the block's side, stay whole.
const float kNodeShare = 0.25;

// Numbers of nodes in the list and of nodes on the stack, which wait to be opened.
uint listed = 0;
uint size = 0;

// If it may win, lists each lane's node or pushes it on the stack.
void offerNodes(Block block, Corners corners, uint list, bool isOffered, uint node) {
  bool survives = false, isWhole = false;
  if (isOffered) {
    const Disc disc = readDisc(push.discs, node);
    survives = disc.radius >= 0 && mayWin(tangentOf(disc, block.centre), block, corners);
    isWhole = isLeaf(node) || disc.radius <= kNodeShare * push.side;
  }
  const uvec4 whole = subgroupBallot(survives && isWhole), open = subgroupBallot(survives && !isWhole);
  if (survives && isWhole) push.lists.at[list + listed + subgroupBallotExclusiveBitCount(whole)] = node;
  if (survives && !isWhole) stackNodes[onStack(size + subgroupBallotExclusiveBitCount(open))] = node;
  listed += subgroupBallotBitCount(whole);
  size += subgroupBallotBitCount(open);
  shareWithSubgroup();
}

// Stops opening nodes when the list is nearly full; the rest are listed as they are.
void listNodes(Block block, Corners corners, List above, uint list) {
  for (uint first = 0; first < above.count; first += gl_SubgroupSize)
    offerNodes(block, corners, list, first + lane() < above.count, listedNode(above, first + lane()));
  while (size > 0) {
    const uint room = (kListNodes - listed - size) / (kTreeArity - 1);
    const uint taken = min(min(size, room), max(gl_SubgroupSize / kTreeArity, 1));
    if (taken == 0) break;
    size -= taken;
    const uint parent = parentAbove(size);
    shareWithSubgroup();
    for (uint child = lane() % kTreeArity; child < kTreeArity; child += gl_SubgroupSize)
      offerNodes(block, corners, list, lane() / kTreeArity < taken, firstChildOf(parent) + child);
  }
  for (uint i = lane(); i < size; i += gl_SubgroupSize) push.lists.at[list + listed + i] = stackNodes[onStack(i)];
}

void main() {
  const uvec3 blocks = blocksAlong(push.side);
  const uint index = subgroupIndex();
  if (index >= countOf(blocks)) return;
  const uvec3 place = placeOf(index, blocks);
  const Block block = blockAt(place);
  const List above = listAbove(place);
  const uint closest = above.hint == kNoneClosest ? kNoneClosest : findCentre(block, above);
  if (closest != kNoneClosest) listNodes(block, measureCorners(closest, block), above, index * kListWords + 2);
  if (lane() != 0) return;
  push.lists.at[index * kListWords] = listed + size;
  push.lists.at[index * kListWords + 1] = closest;
  if (index > 0) return;
  push.heavy.at[0] = 0;
  if (uint64_t(push.left) != 0) push.left.at[0] = 0;
}
