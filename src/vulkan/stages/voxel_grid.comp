// Lists the pairs of triangles with few rows of cells, a triangle per invocation, and the parts of the other triangles.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/voxel_grid_rows.glsl"

void listParts(uint triangle, uint rows) {
  const uint count = ceilDiv(rows, kPartRows), first = atomicAdd(push.totals.at[kPartsWord], count);
  for (uint part = 0; part < count && first + part < mostParts(push.mostRows); ++part)
    push.rows.at[first + part] = rowWord(triangle, part * kPartRows);
}

void main() {
  const uint triangle = invocationIndex();
  uint rows = triangle < push.triangleCount ? rowCount(readLocalTriangle(triangle)) : 0;
  addToTotal(kRowsWord, rows);
  if (rows > kFewRows) {
    listParts(triangle, rows);
    rows = 0;
  }
  const uint mostRows = subgroupMax(rows);
  for (uint row = 0; row < mostRows; ++row) {
    CellRun run = kNoRun;
    if (row < rows) run = findRun(triangle, row);
    listRuns(run);
  }
}
