// Declarations shared by the kernels of the exact distance. Every subgroup handles a block of samples.

#include "vulkan/stages/exact_distance_push.h"
#include "vulkan/stages/surface_tree_push.h"
#include "vulkan/stages/surface_shapes.glsl"

layout(constant_id = 1) const uint kMaxSubgroups = 1;  // Per group.
layout(push_constant, scalar) uniform Push { ExactDistancePush push; };

// Capacity of a stack in nodes, and the most nodes that opening one at a time leaves there: seven on each of
// the levels below.
const uint kStack = 320;
const uint kMostOpened = 7 * 10 + 1;

const uint kArityBits = 3;  // Of kTreeArity.

shared uint stackNodes[kMaxSubgroups * kStack];
shared uint stackBounds[kMaxSubgroups * kStack];  // Bits of floats.
shared float cornerDistances[kMaxSubgroups * 8];

// Approximate number of loop iterations so far.
uint work = 0;

// Returns the same value in the whole subgroup.
bool isTooMuchWork() {
  if (push.mostWork == 0) return false;
  work = subgroupMax(work);
  return work > push.mostWork;
}

uint lane() {
  return gl_SubgroupInvocationID;
}

// Place of a lane's node or triangle below its parent, and that parent's place among those that are opened together.
uint childOfLane() {
  return lane() & (kTreeArity - 1);
}

uint parentOfLane() {
  return lane() >> kArityBits;
}

uint subgroupIndex() {
  return groupIndex() * gl_NumSubgroups + gl_SubgroupID;
}

void shareWithSubgroup() {
  subgroupMemoryBarrierShared();
  subgroupBarrier();
}

uint onStack(uint place) {
  return gl_SubgroupID * kStack + place;
}

// Returns the node that a lane's child or triangle belongs to, if it was taken: the nodes above the stack's new
// size. Other lanes get any node.
uint parentAbove(uint size) {
  return stackNodes[onStack(min(size + parentOfLane(), kStack - 1))];
}

bool isLeaf(uint node) {
  return node >= push.firstLeaf;
}

uint firstTriangleOf(uint leaf) {
  return (leaf - push.firstLeaf) * kTreeArity;
}

uint firstChildOf(uint node) {
  return node * kTreeArity + 1;
}

// Samples of a block, inside the grid. Its side is a power of two.
struct Block {
  uvec3 low, high;  // [low, high).
  vec3 centre, reach;
};

uvec3 blocksAlong(uint side) {
  return (push.dims + (side - 1)) >> findLSB(side);
}

Block blockFrom(uvec3 low, uvec3 high) {
  return Block(low, high, 0.5 * vec3(low + high - 1), 0.5 * vec3(high - low - 1));
}

Block blockAt(uvec3 place) {
  return blockFrom(place * push.side, min((place + 1) * push.side, push.dims));
}

// Returns the number of nodes to open at once with `size` others on the stack: enough that all lanes get a
// child, unless the stack lacks the capacity.
uint openable(uint size) {
  const uint room = max(kStack - kMostOpened, size) - size;
  return max(min(gl_SubgroupSize, room) >> kArityBits, 1);
}

// Pushes the wanted nodes on the stack, the one with the least bound last.
void pushNodes(inout uint size, bool isWanted, uint node, float bound) {
  const uvec4 wanted = subgroupBallot(isWanted);
  const uint count = subgroupBallotBitCount(wanted);
  if (count == 0) return;
  const float least = subgroupMinSquare(isWanted ? bound : kLargestFloat);
  const uint last = subgroupBallotFindLSB(subgroupBallot(isWanted && bound == least));
  const uint rank = subgroupBallotExclusiveBitCount(wanted);
  const uint place = onStack(size + (lane() == last ? count - 1 : rank - uint(lane() > last)));
  if (isWanted) {
    stackNodes[place] = node;
    stackBounds[place] = floatBitsToUint(bound);
  }
  size += count;
  shareWithSubgroup();
}

// Reads the top of the stack, drops nodes whose bound is not below `squared`, and takes some nodes to open.
// These lie from the new size on.
uint takeNodes(inout uint size, float squared) {
  const uint seen = min(size, gl_SubgroupSize), base = size - seen;
  const bool isSeen = lane() < seen;
  const uint node = isSeen ? stackNodes[onStack(base + lane())] : 0;
  const float bound = isSeen ? uintBitsToFloat(stackBounds[onStack(base + lane())]) : kLargestFloat;
  const bool isKept = bound < squared;
  const uvec4 kept = subgroupBallot(isKept);
  const uint count = subgroupBallotBitCount(kept), place = onStack(base + subgroupBallotExclusiveBitCount(kept));
  shareWithSubgroup();
  if (isKept) {
    stackNodes[place] = node;
    stackBounds[place] = floatBitsToUint(bound);
  }
  shareWithSubgroup();
  const uint taken = min(count, openable(base + count));
  size = base + count - taken;
  return taken;
}

struct Closest {
  float squared;
  uint triangle;  // Index among the frames.
};

void takeClosest(inout Closest closest, float squared, uint triangle) {
  const float least = subgroupMinSquare(squared);
  if (!(least < closest.squared)) return;
  closest.squared = least;
  closest.triangle = subgroupMin(squared == least ? triangle : kNoneClosest);
}

// Finds the closest triangle to a point below the nodes on the stack, nearer ones first.
void findClosest(vec3 point, uint size, inout Closest closest) {
  while (size > 0 && !isTooMuchWork()) {
    const uint taken = takeNodes(size, closest.squared);
    const uint parent = parentAbove(size);
    const bool isTaken = parentOfLane() < taken;
    const bool hasTriangles = isTaken && isLeaf(parent);
    shareWithSubgroup();
    for (uint child = childOfLane(); child < kTreeArity; child += gl_SubgroupSize) {
      float squared = kLargestFloat;
      if (hasTriangles)
        squared = squaredDistance(readTriangle(push.frames, firstTriangleOf(parent) + child), point);
      else if (isTaken)
        squared = squaredDistance(readDisc(push.discs, firstChildOf(parent) + child), point);
      takeClosest(closest, hasTriangles ? squared : kLargestFloat, firstTriangleOf(parent) + child);
      pushNodes(size, !hasTriangles && squared < closest.squared, firstChildOf(parent) + child, squared);
    }
    work += 3;
  }
}

// List from the block above: nodes that hold every triangle that may matter, and the triangle closest to that
// block's centre; kNoneClosest if the band does not reach the block.
struct List {
  uint at, count, hint;
};

List listAbove(uvec3 place) {
  if (uint64_t(push.parents) == 0) return List(0, 1, 0);
  const uvec3 above = place >> findLSB(push.blocksPerParent), counts = blocksAlong(push.side * push.blocksPerParent);
  const uint at = indexOf(above, counts) * kListWords;
  return List(at + 2, push.parents.at[at], push.parents.at[at + 1]);
}

uint listedNode(List list, uint index) {
  return uint64_t(push.parents) == 0 || index >= list.count ? 0 : push.parents.at[list.at + index];
}

// Finds the closest triangle to a point below the nodes of a list.
void findClosestOfList(vec3 point, List list, inout Closest closest) {
  uint size = 0;
  for (uint first = 0; first < list.count; first += gl_SubgroupSize) {
    const uint node = listedNode(list, first + lane());
    const float bound = squaredDistance(readDisc(push.discs, node), point);
    pushNodes(size, first + lane() < list.count && bound < closest.squared, node, bound);
  }
  findClosest(point, size, closest);
}

// Returns the distance up to which triangles may matter to some sample of the block; 0: any distance.
float bandOf(Block block) {
  if (push.isAddition == 0) return push.band;
  const uvec3 size = block.high - block.low;
  const uint count = countOf(size);
  float farthest = 0;
  for (uint s = lane(); s < count; s += gl_SubgroupSize)
    farthest = max(farthest, push.distance.at[indexOf(block.low + placeOf(s, size), push.dims)]);
  work += count / gl_SubgroupSize;
  return subgroupMax(farthest);
}

// Returns the triangle closest to the block's centre; kNoneClosest if the band does not reach the block.
uint findCentre(Block block, List list) {
  const float hinted = squaredDistance(readTriangle(push.frames, list.hint), block.centre), band = bandOf(block);
  const float reach = 1.000001 * (band + length(block.reach)), limit = band > 0 ? reach * reach : kLargestFloat;
  Closest closest = hinted < limit ? Closest(hinted, list.hint) : Closest(limit, kNoneClosest);
  findClosestOfList(block.centre, list, closest);
  if (closest.triangle == kNoneClosest && (band == 0 || isTooMuchWork())) return list.hint;
  return closest.triangle;
}

// Distance of the dominating triangle, minus the tolerance, at the corners of a block.
struct Corners {
  vec4 low, high;
};

float limitOf(float squared) {
  squared = max(squared, 1e-30);
  return squared * inverseRoot(squared) - push.tolerance;
}

Corners measureCorners(uint triangle, Block block) {
  for (uint corner = lane(); corner < 8; corner += gl_SubgroupSize) {
    const vec3 sign = 2 * vec3(corner & 1, corner >> 1 & 1, corner >> 2) - 1, at = block.centre + sign * block.reach;
    cornerDistances[gl_SubgroupID * 8 + corner] = limitOf(squaredDistance(readTriangle(push.frames, triangle), at));
  }
  shareWithSubgroup();
  const uint first = gl_SubgroupID * 8;
  return Corners(vec4(cornerDistances[first], cornerDistances[first + 1], cornerDistances[first + 2],
                      cornerDistances[first + 3]),
                 vec4(cornerDistances[first + 4], cornerDistances[first + 5], cornerDistances[first + 6],
                      cornerDistances[first + 7]));
}

// Returns what a gradient adds at the corners (-1, -1), (1, -1), (-1, 1) and (1, 1) of x and y.
vec4 acrossOf(vec3 g) {
  return vec4(-g.x - g.y, g.x - g.y, g.y - g.x, g.x + g.y);
}

// Returns whether a candidate may be closest to some sample of the block. The distance to the candidate is
// convex, so its tangent plane at the centre is a lower bound. The distance to the dominating triangle is
// convex, too. If it stays below that plane at the eight corners, it does so everywhere between them.
bool mayWin(Tangent t, Block block, Corners corners) {
  const vec3 g = t.g * block.reach;
  const vec4 across = acrossOf(g);
  return any(lessThan(t.d - g.z + across, corners.low)) || any(lessThan(t.d + g.z + across, corners.high));
}
