// Lists the pairs of the rows for which floats do not suffice. This is a kernel of its own because few rows need it, and
// its many values would leave room for fewer invocations at once.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/voxel_grid.glsl"
#include "vulkan/stages/cell_runs_exact.glsl"

void main() {
  const uint index = push.firstGroup * gl_WorkGroupSize.x + invocationIndex();
  CellRun run = kNoRun;
  if (index < min(push.totals.at[kOpenRowsWord], push.mostRows)) {
    const uint64_t word = push.rows.at[mostParts(push.mostRows) + index];
    const Row row = readRow(uint(word >> 32), uint(word));
    run = runOf(row, findRunExactly(row.local, row.j, row.k));
  }
  listRuns(run);
}
