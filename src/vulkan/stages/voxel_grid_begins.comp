// Finds the first entry of each cell, in no particular order of the cells.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/voxel_grid_push.h"

layout(push_constant, scalar) uniform Push { VoxelGridListsPush push; };

// If this is false there are no entries, and the host reserves more memory.
bool fits() {
  return push.totals.at[1] == 0 && push.totals.at[0] <= push.mostRows && push.totals.at[3] == 0 &&
         push.totals.at[2] <= push.mostPairs;
}

void main() {
  const uint pair = push.firstGroup * gl_WorkGroupSize.x + invocationIndex();
  const bool isFirst = fits() && pair < push.totals.at[2] && push.places.at[pair] == 0;
  const uint cell = isFirst ? push.cells.at[pair] : 0, size = isFirst ? push.begins.at[cell] + 1 : 0;
  const uint before = subgroupExclusiveAdd(size), total = subgroupAdd(size);
  uint first = 0;
  if (subgroupElect() && total > 0) first = atomicAdd(push.totals.at[6], total);
  first = subgroupBroadcastFirst(first);
  if (isFirst) push.begins.at[cell] = first + before;
}
