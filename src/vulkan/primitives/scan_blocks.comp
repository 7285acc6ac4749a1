// Computes the sums before each element of a block, including the sum before the block.
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

shared uint shares[kScanGroup / 4];  // Of the sum before the block, per subgroup.

uint shareBefore(uint group) {
  if (uint64_t(push.blockSums) == 0) return 0;
  if (push.areSummed != 0) return laneIndex() == 0 ? push.blockSums.at[group] : 0;
  uint sum = 0;
  for (uint block = laneIndex(); block < group; block += kScanGroup) sum += push.blockSums.at[block];
  return sum;
}

// Replaces the partials by the sums before them and returns the total. Called by one subgroup.
uint scanPartials() {
  uint before = 0;
  for (uint i = 0; i < gl_NumSubgroups; ++i) before += shares[i];
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
  const uint share = subgroupAdd(shareBefore(group));
  if (subgroupElect()) shares[gl_SubgroupID] = share;
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
    const uint total = scanPartials();
    if (group == lastGroup && subgroupElect()) push.sums.at[count] = total;
  }
  barrier();
  [[unroll]] for (uint row = 0; row < kScanRows; ++row) {
    const uvec4 v = values[row];
    const uint sum = partials[row * gl_NumSubgroups + gl_SubgroupID] + before[row];
    store(elementIndex(group, row), sum + uvec4(0, v.x, v.x + v.y, v.x + v.y + v.z), count);
  }
}
