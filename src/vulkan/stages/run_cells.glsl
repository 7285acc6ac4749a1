// The cells of a group's runs, one after another: for kernels that CellRuns dispatches, of kRunsGroup invocations.

#include "vulkan/stages/cell_runs_push.h"

shared uint runStarts[kRunsGroup + 1];  // From the group's first cell.

// Before anything else, by the whole group.
void loadRunStarts(Uints starts, uint rows) {
  const uint first = groupIndex() * kRunsGroup;
  for (uint i = gl_LocalInvocationIndex; i <= kRunsGroup; i += gl_WorkGroupSize.x)
    runStarts[i] = starts.at[min(first + i, rows)] - starts.at[first];
  barrier();
}

// Which of the group's runs has a cell.
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
