// Reduces, then scans: each element is read twice and written once. Decoupled look-back would read it once,
// but needs forward progress of work groups while others wait for them. Vulkan does not guarantee that. A
// block adds up the sums of up to 4096 blocks before it by itself: a step less than their prefix sum.

#include "vulkan/primitives/scan.h"

#include <algorithm>
#include <stdexcept>

#include "shaders/scan_blocks_spv.h"
#include "shaders/scan_reduce_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kLargestScan = uint32_t{1} << 31;

/// Returns the number of elements of level `level` for `count` elements of the first level.
uint32_t sizeOf(uint32_t count, uint32_t level) {
  return static_cast<uint32_t>((uint64_t{count} + (uint64_t{1} << (kScanBlockLog2 * level)) - 1) >>
                               (kScanBlockLog2 * level));
}

uint32_t levelsOf(uint32_t count) {
  if (count <= kScanBlock) return 1;
  return count <= kScanBlock * kScanBlock ? 2 : 3;
}

}  // namespace

Scan::Scan(Device& device)
    : reduce_(device, shaders::kScanReduce, kScanGroup),
      blocks_(device, shaders::kScanBlocks, kScanGroup),
      blockSums_{DeviceBuffer(device, "scan block sums"), DeviceBuffer(device, "scan upper block sums")} {}

void Scan::reserve(uint32_t most) {
  if (most > kLargestScan) throw std::logic_error("a prefix sum over more than 2^31 elements");
  for (uint32_t level = 0; level + 1 < levelsOf(most); ++level)
    blockSums_[level].resize<uint32_t>(sizeOf(most, level + 1) + 1);
  reserved_ = most;
}

void Scan::record(Commands& commands, VkDeviceAddress values, VkDeviceAddress sums, uint32_t count) {
  if (count > reserved_) throw std::logic_error("a prefix sum over more elements than reserved");
  if (values % 16 != 0 || sums % 16 != 0)
    throw std::logic_error("a prefix sum not at a multiple of 16 bytes");
  const uint32_t levels = levelsOf(count);
  for (uint32_t level = 0; level + 1 < levels; ++level)
    dispatch(commands, reduce_, push(level, levels, values, sums, count));
  for (uint32_t level = std::max(levels, 2U) - 1; level-- > 0;)
    dispatch(commands, blocks_, push(level, levels, values, sums, count));
}

ScanPush Scan::push(uint32_t level, uint32_t levels, VkDeviceAddress values, VkDeviceAddress sums,
                    uint32_t count) const {
  return {.values = level == 0 ? values : blockSums_[level - 1].address(),
          .sums = level == 0 ? sums : blockSums_[level - 1].address(),
          .blockSums = level + 1 < levels ? blockSums_[level].address() : 0,
          .count = sizeOf(count, level),
          .areSummed = level + 2 < levels ? 1U : 0U};
}

void Scan::dispatch(Commands& commands, Kernel<ScanPush>& kernel, const ScanPush& push) {
  // One group runs even for no elements, to write the total.
  commands.dispatch(kernel, push, uint64_t{std::max(sizeOf(push.count, 1), 1U)} * kScanGroup);
}

}  // namespace raymap::vulkan
