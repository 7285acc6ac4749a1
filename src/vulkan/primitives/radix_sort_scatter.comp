// Writes each of a group's elements to the place given by its digit and its rank within that digit.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/primitives/radix_sort.glsl"

// Per subgroup and digit: the number of elements so far, then the place of the first one.
shared uint bins[kMaxSubgroups * kRadixBins];

// Returns the lanes with the same digit as this one, among those inside.
uvec4 peersOf(uint digit, bool inside) {
  uvec4 peers = subgroupBallot(inside);
  [[unroll]] for (uint bit = 0; bit < kRadixBits; ++bit) {
    const bool isSet = (digit >> bit & 1) != 0;
    const uvec4 set = subgroupBallot(isSet);
    peers &= isSet ? set : ~set;
  }
  return peers;
}

// Returns the number of the subgroup's elements with this digit before this one, then counts this one.
uint rankIn(uint bin, uvec4 peers, bool inside) {
  const uint before = subgroupBallotExclusiveBitCount(peers);
  const uint rank = bins[bin] + before;
  subgroupMemoryBarrierShared();
  subgroupBarrier();
  if (inside && before == 0) bins[bin] += subgroupBallotBitCount(peers);
  subgroupMemoryBarrierShared();
  subgroupBarrier();
  return rank;
}

void main() {
  const uint groups = groupCount();
  if (groupIndex() >= groups) return;
  for (uint bin = laneIndex(); bin < gl_NumSubgroups * kRadixBins; bin += gl_WorkGroupSize.x) bins[bin] = 0;
  barrier();
  uint bin[kRadixRows];
  uint rank[kRadixRows];
  [[unroll]] for (uint row = 0; row < kRadixRows; ++row) {
    const uint index = elementIndex(row);
    const bool inside = index < push.count;
    const uint digit = inside ? digitOf(index) : 0;
    bin[row] = gl_SubgroupID * kRadixBins + digit;
    rank[row] = rankIn(bin[row], peersOf(digit, inside), inside);
  }
  barrier();
  for (uint digit = laneIndex(); digit < kRadixBins; digit += gl_WorkGroupSize.x) {
    uint first = push.histogram.at[digit * groups + groupIndex()];
    for (uint i = digit; i < gl_NumSubgroups * kRadixBins; i += kRadixBins) {
      const uint size = bins[i];
      bins[i] = first;
      first += size;
    }
  }
  barrier();
  [[unroll]] for (uint row = 0; row < kRadixRows; ++row) {
    const uint from = elementIndex(row);
    if (from >= push.count) continue;
    const uint to = bins[bin[row]] + rank[row];
    push.sortedKeys.at[to] = push.keys.at[from];
    push.sortedValues.at[to] = push.values.at[from];
  }
}
