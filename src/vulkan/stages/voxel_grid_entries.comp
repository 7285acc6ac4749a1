// Writes every cell of every run and the run's triangle, by ascending triangles.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/voxel_grid_push.h"
#include "vulkan/stages/run_cells.glsl"

layout(push_constant, scalar) uniform Push { VoxelGridPush push; };

// If this is false there are no entries, and the host reserves more memory.
bool fits() {
  return push.totals.at[1] == 0 && push.totals.at[0] <= push.mostRows && push.totals.at[3] == 0 &&
         push.totals.at[2] <= push.mostEntries;
}

void main() {
  const uint rows = push.totals.at[0];
  if (invocationIndex() == 0) push.count.at[0] = fits() ? push.totals.at[2] : 0;
  if (!fits() || groupIndex() * kRunsGroup >= rows) return;
  loadRunStarts(push.runStarts, rows);
  const uint firstRun = groupIndex() * kRunsGroup, firstEntry = push.runStarts.at[firstRun];
  for (uint number = gl_LocalInvocationIndex; number < runStarts[kRunsGroup]; number += gl_WorkGroupSize.x) {
    const uint run = runOf(number);
    push.cells.at[firstEntry + number] = push.runCells.at[firstRun + run] + (number - runStarts[run]);
    push.triangles.at[firstEntry + number] = push.runTriangles.at[firstRun + run];
  }
}
