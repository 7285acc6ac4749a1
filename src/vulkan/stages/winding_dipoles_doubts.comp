// Lists the samples so close to the threshold that the lattice may have put them on the wrong side. Their order
// varies from run to run.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/winding_dipoles.glsl"

void list(bool isFound, uint sampleIndex) {
  const uvec4 found = subgroupBallot(isFound);
  const uint count = subgroupBallotBitCount(found);
  uint first = 0;
  if (count > 0 && subgroupElect()) first = atomicAdd(push.doubts.at[0], count);
  const uint place = subgroupBroadcastFirst(first) + subgroupBallotExclusiveBitCount(found);
  if (isFound && place < push.mostListed) push.doubts.at[1 + place] = sampleIndex;
}

void main() {
  if (push.disagreeing.at[0] == 0) return;
  const uint first = groupIndex() * kDoubtsEach * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
  for (uint n = 0; n < kDoubtsEach; ++n) {
    const uint i = first + n * gl_WorkGroupSize.x;
    list(i < countOf(push.dims) && isDoubtful(i), i);
  }
}
