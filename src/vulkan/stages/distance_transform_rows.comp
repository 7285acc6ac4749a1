// Krayer & Müller 2019, §3.3, Algorithms 1 and 2, along x. Paper: lower envelopes along every axis. Here: triangles
// touch the cells that list them, so no value before this pass exceeds 3/4, and the nearest occupied cell on each
// side is the lowest there. A subgroup handles a line.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "method/cell_lattice_shared.h"
#include "vulkan/stages/distance_transform_push.h"

layout(push_constant, scalar) uniform Push { DistanceTransformPush push; };

// Returns the cells at `first` and after it, one for each lane, that have a value.
uvec4 occupiedFrom(uint row, uint first) {
  const uint x = first + gl_SubgroupInvocationID;
  return subgroupBallot(x < push.dims.x && push.values.at[row + min(x, push.dims.x - 1)] < push.empty);
}

// Returns the nearer of the nearest cells on both sides; of equally near ones, that of the lower value.
uint nearestOf(uint row, uint x, uint left, uint right) {
  if (left == kNoCell || right == kNoCell) return min(left, right);
  const uint before = x - left, after = right - x;
  if (before != after) return before < after ? left : right;
  return push.values.at[row + right] < push.values.at[row + left] ? right : left;
}

void main() {
  const uint line = groupIndex() * gl_NumSubgroups + gl_SubgroupID;
  if (line >= push.dims.y * push.dims.z) return;
  const uint row = line * push.dims.x, size = gl_SubgroupSize, end = ceilDiv(push.dims.x, size) * size;
  uint last = kNoCell, next = kNoCell;
  for (uint first = 0; first < end; first += size) {
    const uvec4 occupied = occupiedFrom(row, first), before = occupied & gl_SubgroupLeMask;
    const uint x = first + gl_SubgroupInvocationID;
    if (x < push.dims.x) push.to.at[row + x] = before == uvec4(0) ? last : first + subgroupBallotFindMSB(before);
    if (occupied != uvec4(0)) last = first + subgroupBallotFindMSB(occupied);
  }
  for (uint first = end; first > 0;) {
    first -= size;
    const uvec4 occupied = occupiedFrom(row, first), after = occupied & gl_SubgroupGeMask;
    const uint x = first + gl_SubgroupInvocationID;
    const uint right = after == uvec4(0) ? next : first + subgroupBallotFindLSB(after);
    if (x < push.dims.x) push.to.at[row + x] = nearestOf(row, x, push.to.at[row + x], right);
    if (occupied != uvec4(0)) next = first + subgroupBallotFindLSB(occupied);
  }
}
