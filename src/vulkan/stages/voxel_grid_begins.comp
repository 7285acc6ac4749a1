// Finds the first entry of each cell, in no particular order of the cells.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/voxel_grid_push.h"

layout(push_constant, scalar) uniform Push { VoxelGridListsPush push; };

// If this is false there are no entries, and the host reserves more memory.
bool fits() {
  return push.totals.at[kRowsWord + 1] == 0 && push.totals.at[kRowsWord] <= push.mostRows &&
         push.totals.at[kPairsWord + 1] == 0 && push.totals.at[kPairsWord] <= push.mostPairs;
}

void main() {
  const uint pair = push.firstGroup * gl_WorkGroupSize.x + invocationIndex();
  const bool isFirst = fits() && pair < push.totals.at[kPairsWord] && push.places.at[pair] == 0;
  const uint cell = isFirst ? push.cells.at[pair] : 0, size = isFirst ? push.begins.at[cell] + 1 : 0;
  const uint before = subgroupExclusiveAdd(size), total = subgroupAdd(size);
  uint first = 0;
  if (subgroupElect() && total > 0) first = atomicAdd(push.totals.at[kEntriesWord], total);
  first = subgroupBroadcastFirst(first);
  if (isFirst) push.begins.at[cell] = first + before;
}
