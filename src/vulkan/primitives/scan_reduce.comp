// Sums each block, for the level above.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/primitives/scan.glsl"

void main() {
  const uint group = groupIndex();
  if (group >= ceilDiv(push.count, kScanBlock)) return;
  uint sum = 0;
  [[unroll]] for (uint row = 0; row < kScanRows; ++row) {
    const uvec4 values = load(elementIndex(group, row), push.count);
    sum += values.x + values.y + values.z + values.w;
  }
  sum = subgroupAdd(sum);
  if (subgroupElect()) partials[gl_SubgroupID] = sum;
  barrier();
  if (gl_SubgroupID != 0) return;
  uint total = 0;
  for (uint i = gl_SubgroupInvocationID; i < gl_NumSubgroups; i += gl_SubgroupSize) total += partials[i];
  total = subgroupAdd(total);
  if (subgroupElect()) push.blockSums.at[group] = total;
}
