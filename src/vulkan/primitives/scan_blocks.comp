// Computes the sums before each element of a block, including the sum before the block.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/primitives/scan.glsl"

void store(uint index, uvec4 sums, uint count) {
  if (index + 4 <= count) {
    Uvec4s(push.sums).at[index / 4] = sums;
    return;
  }
  for (uint i = 0; i < 4 && index + i < count; ++i) push.sums.at[index + i] = sums[i];
}

// Replaces the partials by the sums before them and returns the total. Called by one subgroup.
uint scanPartials(uint before) {
  const uint size = kScanRows * gl_NumSubgroups;
  for (uint first = 0; first < size; first += gl_SubgroupSize) {
    const uint i = first + gl_SubgroupInvocationID;
    const uint value = i < size ? partials[i] : 0;
    const uint sum = before + subgroupExclusiveAdd(value);
    if (i < size) partials[i] = sum;
    before += subgroupAdd(value);
  }
  return before;
}

void main() {
  const uint group = groupIndex();
  const uint count = push.count;
  // One group runs even for no elements, to write the total.
  const uint lastGroup = max(ceilDiv(count, kScanBlock), 1) - 1;
  if (group > lastGroup) return;
  uvec4 values[kScanRows];
  uint before[kScanRows];
  [[unroll]] for (uint row = 0; row < kScanRows; ++row) {
    values[row] = load(elementIndex(group, row), count);
    const uint sum = values[row].x + values[row].y + values[row].z + values[row].w;
    before[row] = subgroupExclusiveAdd(sum);
    if (gl_SubgroupInvocationID == gl_SubgroupSize - 1)
      partials[row * gl_NumSubgroups + gl_SubgroupID] = before[row] + sum;
  }
  barrier();
  if (gl_SubgroupID == 0) {
    const uint total = scanPartials(uint64_t(push.blockSums) == 0 ? 0 : push.blockSums.at[group]);
    if (group == lastGroup && subgroupElect()) push.sums.at[count] = total;
  }
  barrier();
  [[unroll]] for (uint row = 0; row < kScanRows; ++row) {
    const uvec4 v = values[row];
    const uint sum = partials[row * gl_NumSubgroups + gl_SubgroupID] + before[row];
    store(elementIndex(group, row), sum + uvec4(0, v.x, v.x + v.y, v.x + v.y + v.z), count);
  }
}
