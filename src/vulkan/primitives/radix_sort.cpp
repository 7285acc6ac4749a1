// Sorts by the least significant digit first, 8 bits per pass: count by digit and group, sum, scatter. A
// subgroup ranks its own elements by ballots, row by row, so neither the subgroup's size nor
// the order of groups changes the result.

#include "vulkan/primitives/radix_sort.h"

#include <algorithm>
#include <stdexcept>

#include "shaders/radix_sort_count_spv.h"
#include "shaders/radix_sort_scatter_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kLargestSort = uint32_t{1} << 30;

/// Limits a group to 16 of the smallest subgroups. Each subgroup counts in 1 KiB of shared memory of its own,
/// and every device has 16 KiB.
uint32_t groupSizeOf(const DeviceLimits& limits) {
  constexpr uint32_t kBest = 256;
  constexpr uint32_t kSubgroups = 16;
  return std::max(std::min(kBest, kSubgroups * limits.minSubgroupSize), limits.maxSubgroupSize);
}

}  // namespace

RadixSort::RadixSort(Device& device)
    : groupSize_(groupSizeOf(device.limits())),
      tile_(groupSize_ * kRadixRows),
      count_(device, shaders::kRadixSortCount, groupSize_, {groupSize_ / device.limits().minSubgroupSize}),
      scatter_(device, shaders::kRadixSortScatter, groupSize_,
               {groupSize_ / device.limits().minSubgroupSize}),
      scan_(device),
      histogram_(device, "radix sort histogram") {}

void RadixSort::reserve(uint32_t most) {
  if (most > kLargestSort) throw std::logic_error("a sort of more than 2^30 elements");
  scan_.reserve(kRadixBins * groups(most));
  histogram_.resize<uint32_t>(uint64_t{kRadixBins} * groups(most) + 1);
  reserved_ = most;
}

RadixSort::Pairs RadixSort::record(Commands& commands, Pairs pairs, Pairs other, uint32_t count,
                                   uint32_t keyBits) {
  if (count > reserved_) throw std::logic_error("a sort of more elements than reserved");
  if (keyBits > 32) throw std::logic_error("a sort by more bits than the keys have");
  for (uint32_t bit = 0; bit < keyBits; bit += kRadixBits) {
    const RadixSortPush push{.keys = pairs.keys,
                             .values = pairs.values,
                             .sortedKeys = other.keys,
                             .sortedValues = other.values,
                             .histogram = histogram_.address(),
                             .count = count,
                             .shift = bit,
                             .mask = (1U << std::min(kRadixBits, keyBits - bit)) - 1};
    commands.dispatch(count_, push, uint64_t{groups(count)} * groupSize_);
    scan_.record(commands, push.histogram, push.histogram, kRadixBins * groups(count));
    commands.dispatch(scatter_, push, uint64_t{groups(count)} * groupSize_);
    std::swap(pairs, other);
  }
  return pairs;
}

}  // namespace raymap::vulkan
