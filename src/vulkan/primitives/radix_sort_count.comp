// Counts a group's elements by their digit.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/primitives/radix_sort.glsl"

shared uint bins[kRadixBins];

void main() {
  const uint groups = groupCount();
  if (groupIndex() >= groups) return;
  for (uint bin = laneIndex(); bin < kRadixBins; bin += gl_WorkGroupSize.x) bins[bin] = 0;
  barrier();
  [[unroll]] for (uint row = 0; row < kRadixRows; ++row) {
    const uint index = elementIndex(row);
    if (index < push.count) atomicAdd(bins[digitOf(index)], 1);
  }
  barrier();
  for (uint bin = laneIndex(); bin < kRadixBins; bin += gl_WorkGroupSize.x)
    push.histogram.at[bin * groups + groupIndex()] = bins[bin];
}
