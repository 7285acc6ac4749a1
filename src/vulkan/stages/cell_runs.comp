// Finds the cells that a triangle touches in one row of its bounds' cells. Each invocation handles one row,
// so that large and small triangles take equally long.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/cell_runs.glsl"

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

// Lists the run of a row, and returns its number of cells.
uint listRun(uint row) {
  const uint triangle = triangleOf(row);
  const uint local = row - push.rowStarts.at[triangle];
  const LocalTriangle t = readLocalTriangle(triangle);
  const uint rows = uint(t.extent.y + 1);
  const int j = int(local % rows), k = int(local / rows);
  const ivec2 run = touchedRun(t, j, k);
  const uint size = uint(max(run.y - run.x + 1, 0));
  push.runTriangles.at[row] = triangle;
  push.runCells.at[row] = cellIndex(push.cells, uvec3(t.base + ivec3(run.x, j, k)));
  push.runSizes.at[row] = size;
  return size;
}

void main() {
  const uint row = invocationIndex();
  const bool fits = push.totals.at[1] == 0 && push.totals.at[0] <= push.mostRows;
  addToTotal(2, fits && row < push.totals.at[0] ? listRun(row) : 0);
}
