// Finds the cells that a triangle touches in one row of its bounds' cells. Each invocation handles one row,
// so that large and small triangles take equally long. Lists the rows for which floats do not suffice.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/cell_runs.glsl"
#include "vulkan/stages/cell_runs_rough.glsl"

uint triangleOf(uint row) {
  uint low = 0, high = push.triangleCount;
  while (high - low > 1) {
    const uint middle = (low + high) / 2;
    if (push.rowStarts.at[middle] <= row)
      low = middle;
    else
      high = middle;
  }
  return low;
}

// Returns whether the run is known.
bool findRun(Row row, out ivec2 run) {
  const ivec3 extent = row.local.extent;
  run = ivec2(0, extent.x);
  // Within one line of cells the bounds decide.
  if (!row.local.isCut && int(extent.x > 0) + int(extent.y > 0) + int(extent.z > 0) <= 1) return true;
  return findRunRoughly(row.local, row.j, row.k, run);
}

// Lists the run of a row, and returns its number of cells if it is known.
uint listRun(uint number) {
  const uint triangle = triangleOf(number);
  push.runTriangles.at[number] = triangle;
  const Row row = readRow(number, triangle);
  ivec2 run;
  if (findRun(row, run)) return writeRun(row, run);
  push.unknown.at[atomicAdd(push.unknownCount.at[0], 1)] = number;  // In no particular order.
  return 0;
}

void main() {
  const uint row = invocationIndex();
  const bool fits = push.totals.at[1] == 0 && push.totals.at[0] <= push.mostRows;
  addToTotal(2, fits && row < push.totals.at[0] ? listRun(row) : 0);
}
