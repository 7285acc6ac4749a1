// Lists the pairs of the rows for which floats do not suffice. This is a kernel of its own because few rows need it, and
// its many values would leave room for fewer invocations at once. Doubles in software are a long chain of integers, so
// several invocations share a row.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/voxel_grid.glsl"
#include "vulkan/stages/cell_runs_exact.glsl"

shared Interval clips[kOpenRowsGroup];

void intersect(inout Interval interval, Interval other) {
  interval = Interval(maximum(interval.low, other.low), minimum(interval.high, other.high));
}

ivec2 findRun(Row row, uint first) {
  Interval rows = clips[first], cells = clips[first + 3];
  for (uint n = 1; n < 3; ++n) intersect(rows, clips[first + n]);
  for (uint n = 4; n < kClips; ++n) intersect(cells, clips[first + n]);
  return runBetween(rows, cells, row.j);
}

// Each invocation makes one clip of a row, and the first one of each row lists its run.
void main() {
  const uint lane = laneIndex(), clip = lane % kOpenRowLanes;
  const uint index = ((push.firstGroup + groupIndex()) * kOpenRowsGroup + lane) / kOpenRowLanes;
  const bool isOpen = index < min(push.totals.at[kOpenRowsWord], push.mostRows);
  Row row;
  if (isOpen) {
    const uint64_t word = push.rows.at[mostParts(push.mostRows) + index];
    row = readRow(uint(word >> 32), uint(word));
    if (clip < kClips) clips[lane] = clipOf(row.local, clip, row.j, row.k);
  }
  barrier();
  CellRun run = kNoRun;
  if (isOpen && clip == 0) run = runOf(row, findRun(row, lane));
  listRuns(run);
}
