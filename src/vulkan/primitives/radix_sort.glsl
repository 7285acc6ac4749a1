// Declarations shared by both kernels of the radix sort.

#include "vulkan/primitives/radix_sort_push.h"

layout(constant_id = 1) const uint kMaxSubgroups = 1;  // Per group.
layout(push_constant, scalar) uniform Push { RadixSortPush push; };

uint groupCount() {
  return ceilDiv(push.count, kRadixRows * gl_WorkGroupSize.x);
}

// Subgroups have consecutive rows of elements, so the order is that of subgroups, rows, lanes.
uint elementIndex(uint row) {
  const uint firstRow = groupIndex() * kRadixRows * gl_WorkGroupSize.x + gl_SubgroupID * kRadixRows * gl_SubgroupSize;
  return firstRow + row * gl_SubgroupSize + gl_SubgroupInvocationID;
}

uint digitOf(uint index) {
  return push.keys.at[index] >> push.shift & push.mask;
}
