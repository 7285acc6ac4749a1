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

RadixSort::RadixSort(Device& device, uint32_t keyWords)
    : groupSize_(groupSizeOf(device.limits())),
      tile_(groupSize_ * kRadixRows),
      keyWords_(keyWords),
      count_(device, shaders::kRadixSortCount, groupSize_,
             {groupSize_ / device.limits().minSubgroupSize, keyWords}),
      scatter_(device, shaders::kRadixSortScatter, groupSize_,
               {groupSize_ / device.limits().minSubgroupSize, keyWords}),
      scan_(device),
      arguments_(device, "radix sort arguments", 1),
      histogram_(device, "radix sort histogram") {}

void RadixSort::reserve(uint32_t most) {
  if (most > kLargestSort) throw std::logic_error("a sort of more than 2^30 elements");
  scan_.reserve(kRadixBins * groups(most));
  histogram_.resize<uint32_t>(uint64_t{kRadixBins} * groups(most) + 1);
  reserved_ = most;
}

RadixSort::Pairs RadixSort::record(Commands& commands, Pairs pairs, Pairs other, Count count,
                                   uint32_t keyBits) {
  if (count.most > reserved_) throw std::logic_error("a sort of more elements than reserved");
  if (keyBits > 32 * keyWords_) throw std::logic_error("a sort by more bits than the keys have");
  if (count.address != 0)
    arguments_.record(commands, 0, {.count = count, .itemsPerGroup = tile_, .scale = kRadixBins});
  for (uint32_t bit = 0; bit < keyBits; bit += kRadixBits) {
    pass(commands, {.keys = pairs.keys,
                    .values = pairs.values,
                    .sortedKeys = other.keys,
                    .sortedValues = other.values,
                    .histogram = histogram_.address(),
                    .count = count.address,
                    .most = count.most,
                    .word = bit / 32,
                    .shift = bit % 32,
                    .mask = (1U << std::min(kRadixBits, keyBits - bit)) - 1});
    std::swap(pairs, other);
  }
  return pairs;
}

void RadixSort::pass(Commands& commands, const RadixSortPush& push) {
  dispatch(commands, count_, push);
  scan_.record(
      commands, push.histogram, push.histogram,
      {.most = kRadixBins * groups(push.most), .address = push.count != 0 ? arguments_.scaledGroups(0) : 0});
  dispatch(commands, scatter_, push);
}

void RadixSort::dispatch(Commands& commands, Kernel<RadixSortPush>& kernel, const RadixSortPush& push) {
  if (push.count != 0)
    arguments_.dispatch(commands, kernel, push, 0);
  else
    commands.dispatch(kernel, push, uint64_t{groups(push.most)} * groupSize_);
}

}  // namespace raymap::vulkan
