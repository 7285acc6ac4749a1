// The cells that a triangle touches in a row of its bounds' cells, where floats suffice to tell.

#include "vulkan/stages/voxel_grid.glsl"
#include "vulkan/stages/cell_runs_rough.glsl"

// Returns whether the run is known.
bool findRun(Row row, out ivec2 run) {
  const ivec3 extent = row.local.extent;
  run = ivec2(0, extent.x);
  // Within one line of cells the bounds decide.
  if (!row.local.isCut && int(extent.x > 0) + int(extent.y > 0) + int(extent.z > 0) <= 1) return true;
  return findRunRoughly(row.local, row.j, row.k, run);
}

// Lists the row, in no particular order, if floats do not suffice.
CellRun findRun(uint triangle, uint number) {
  const Row row = readRow(triangle, number);
  ivec2 run;
  if (findRun(row, run)) return runOf(row, run);
  const uint at = atomicAdd(push.totals.at[kOpenRowsWord], 1);
  if (at < push.mostRows) push.rows.at[mostParts(push.mostRows) + at] = rowWord(triangle, number);
  return kNoRun;
}
