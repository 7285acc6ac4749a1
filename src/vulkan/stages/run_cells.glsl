// Consecutive cells of a group's runs, for kernels dispatched by CellRunsStage with groups of kRunsGroup
// invocations.

#include "vulkan/stages/cell_runs_push.h"

shared uint runStarts[kRunsGroup + 1];  // Relative to the group's first cell.

// Must be called first, by the whole group.
void loadRunStarts(Uints starts, uint rows) {
  const uint first = groupIndex() * kRunsGroup;
  for (uint i = gl_LocalInvocationIndex; i <= kRunsGroup; i += gl_WorkGroupSize.x)
    runStarts[i] = starts.at[min(first + i, rows)] - starts.at[first];
  barrier();
}

// Returns the group's run that contains a cell.
uint runOf(uint number) {
  uint low = 0, high = kRunsGroup;
  while (high - low > 1) {
    const uint middle = (low + high) / 2;
    if (runStarts[middle] <= number)
      low = middle;
    else
      high = middle;
  }
  return low;
}
