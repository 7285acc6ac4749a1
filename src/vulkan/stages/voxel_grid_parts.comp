// Lists the pairs of a part of a triangle with many rows of cells.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/voxel_grid_rows.glsl"

void main() {
  const uint part = push.firstGroup + groupIndex();
  if (part >= min(push.totals.at[kPartsWord], mostParts(push.mostRows))) return;
  const uint64_t first = push.rows.at[part];
  const uint triangle = uint(first >> 32), lane = gl_LocalInvocationID.x, row = uint(first) + lane;
  CellRun run = kNoRun;
  if (lane < kPartRows && row < rowCount(readLocalTriangle(triangle))) run = findRun(triangle, row);
  listRuns(run);
}
