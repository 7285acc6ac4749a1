// Declarations shared by both kernels of the prefix sum.

#include "vulkan/primitives/scan_push.h"

layout(push_constant, scalar) uniform Push { ScanPush push; };

// Sums of the subgroups in each row; every device's subgroups have at least four invocations.
shared uint partials[kScanRows * kScanGroup / 4];

// Returns the first of the invocation's four elements in a row of its group's block.
uint elementIndex(uint group, uint row) {
  return group * kScanBlock + (row * kScanGroup + laneIndex()) * 4;
}

uvec4 load(uint index, uint count) {
  if (index + 4 <= count) return Uvec4s(push.values).at[index / 4];
  uvec4 values = uvec4(0);
  for (uint i = 0; i < 4 && index + i < count; ++i) values[i] = push.values.at[index + i];
  return values;
}
