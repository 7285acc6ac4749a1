// Ours (Krayer & Müller 2019 keep the nearest cell's triangles, §3.3): the true closest triangle of every
// sample. As on the CPU, blocks of samples get lists of the nodes that may be closest to some sample in them.
// Here this takes three steps. A subgroup handles each block; its lanes are candidates first and samples at
// the end (docs/dev/decisions/vulkan_exact_distance.md).

#include "vulkan/stages/exact_distance.h"

#include <raymap/field.h>

#include <algorithm>

#include "base/ceil_div.h"
#include "shaders/exact_distance_alone_spv.h"
#include "shaders/exact_distance_blocks_spv.h"
#include "shaders/exact_distance_rest_spv.h"
#include "shaders/exact_distance_spv.h"
#include "vulkan/device/dispatch_limits.h"

namespace raymap::vulkan {

namespace {

static_assert(kNoneClosest == kNoTriangle);

/// Some drivers in software end loops after 65,535 iterations. From here on it is too much work for them.
constexpr uint32_t kMostLoops = 20000;
constexpr uint32_t kAnyWork = 1;
/// Work from which on a block keeps a card waiting; with many blocks, others run meanwhile. Of few blocks,
/// every one does (docs/dev/decisions/vulkan_exact_distance.md).
uint32_t heavyWorkOf(uint64_t blocks) {
  constexpr uint64_t kFewBlocks = 2500, kManyBlocks = 16384;
  return blocks <= kFewBlocks ? kAnyWork : blocks <= kManyBlocks ? 2000 : 5000;
}
/// Groups of one dispatch. A multiple of the most along an axis, so that no part has surplus groups.
constexpr uint32_t kAloneGroups = 16 * kMaxGroups;

/// Limits a group to four subgroups, each of which needs 5.6 KiB of shared memory. In software it has one
/// subgroup: drivers may treat a subgroup's barrier as the group's
/// (docs/dev/decisions/vulkan_exact_distance.md).
uint32_t subgroupsFor(const Device& device) {
  constexpr uint32_t kBest = 64;  // Invocations.
  constexpr uint32_t kSubgroups = 4;
  if (device.info().type == DeviceType::Software) return 1;
  return std::min(kBest / device.limits().minSubgroupSize, kSubgroups);
}

/// Returns the invocations of a group. All its subgroups are full, however large they are.
uint32_t groupSizeOf(const Device& device, uint32_t subgroups) {
  const DeviceLimits& limits = device.limits();
  const uint32_t wanted = subgroups > 0 ? subgroups : subgroupsFor(device);
  return std::max(wanted * limits.minSubgroupSize, limits.maxSubgroupSize);
}

}  // namespace

ExactDistanceStage::ExactDistanceStage(Device& device, ScratchMemory* scratch, const Imitated& imitated)
    : hasShortLoops_(device.info().type == DeviceType::Software),
      heavyWork_(imitated.mostWork > 0 ? imitated.mostWork
                 : hasShortLoops_      ? kMostLoops
                                       : 0),
      maxSubgroup_(device.limits().maxSubgroupSize),
      groupSize_(groupSizeOf(device, imitated.subgroups)),
      blocks_(device, shaders::kExactDistanceBlocks, groupSize_,
              {groupSize_ / device.limits().minSubgroupSize, static_cast<uint32_t>(imitated.rootError)}),
      samples_(device, shaders::kExactDistance, groupSize_,
               {groupSize_ / device.limits().minSubgroupSize, static_cast<uint32_t>(imitated.rootError)}),
      alone_(device, shaders::kExactDistanceAlone, groupSize_,
             {groupSize_ / device.limits().minSubgroupSize, static_cast<uint32_t>(imitated.rootError)}),
      rest_(device, shaders::kExactDistanceRest, groupSize_,
            {groupSize_ / device.limits().minSubgroupSize, static_cast<uint32_t>(imitated.rootError)}),
      aloneArguments_(device, "dispatches over samples of heavy blocks"),
      restArguments_(device, "dispatches over samples that are left"),
      lists_{DeviceBuffer(device, "lists of large blocks", scratch),
             DeviceBuffer(device, "lists of blocks", scratch)},
      heavy_(device, "heavy blocks", scratch),
      left_(device, "samples that are left", scratch) {}

void ExactDistanceStage::reserve(const glm::ivec3& dims) {
  dims_ = dims;
  for (uint32_t level = 0; level < kSmallest; ++level)
    lists_[level].resize<uint32_t>(blocks(level) * kListWords);
  heavy_.resize<uint32_t>(1 + blocks(kSmallest));
  left_.resize<uint32_t>(hasShortLoops_ ? 1 + samples() : 0);
  aloneArguments_.reserve({.most = static_cast<uint32_t>(blocks(kSmallest) * kBlockSamples),
                           .itemsPerGroup = groupSize_ / maxSubgroup_,
                           .mostGroups = kAloneGroups});
  restArguments_.reserve({.most = static_cast<uint32_t>(samples()),
                          .itemsPerGroup = groupSize_ / maxSubgroup_,
                          .mostGroups = kAloneGroups});
}

uint32_t ExactDistanceStage::heavyWork() const {
  return heavyWork_ > 0 ? heavyWork_ : heavyWorkOf(blocks(kSmallest));
}

uint64_t ExactDistanceStage::blocks(uint32_t level) const {
  const uint64_t side = kSides[level];
  const glm::u64vec3 along = (glm::u64vec3(dims_) + (side - 1)) / side;
  return along.x * along.y * along.z;
}

void ExactDistanceStage::record(Commands& commands, const SurfaceTreeStage& tree, double band,
                                const Fields& fields, bool isAddition) {
  ExactDistancePush push{.frames = tree.frames().address(),
                         .discs = tree.discs().address(),
                         .distance = fields.distance,
                         .triangle = fields.triangle,
                         .heavy = heavy_.address(),
                         .left = hasShortLoops_ ? left_.address() : 0,
                         .dims = glm::uvec3(dims_),
                         .firstLeaf = tree.firstLeaf(),
                         .leafCount = tree.leafCount(),
                         .band = static_cast<float>(band),
                         .tolerance = 1e-7f * glm::length(glm::vec3(dims_)),
                         .isAddition = isAddition ? 1U : 0U};
  for (uint32_t level = 0; level <= kSmallest; ++level) {
    push.side = kSides[level];
    push.parents = level > 0 ? lists_[level - 1].address() : 0;
    push.blocksPerParent = level > 0 ? kSides[level - 1] / kSides[level] : 0;
    push.lists = level < kSmallest ? lists_[level].address() : 0;
    push.mostWork = level == kSmallest ? heavyWork() : hasShortLoops_ ? kMostLoops : 0;
    if (level == kSmallest && heavyWork() == kAnyWork) break;
    commands.dispatch(level < kSmallest ? blocks_ : samples_, push, blocks(level) * maxSubgroup_);
  }
  recordAlone(commands, push);
  if (!hasShortLoops_) return;
  // Finishes samples that some drivers end too early. Each tests all leaves, some in each pass.
  restArguments_.record(commands, left_.address());
  for (; push.restLeaf < push.leafCount; push.restLeaf += kRestLeaves)
    restArguments_.dispatch(commands, rest_, push);
}

/// A subgroup searches for each sample of heavy blocks. If all are heavy, it starts from the lists of the
/// blocks above.
void ExactDistanceStage::recordAlone(Commands& commands, ExactDistancePush push) {
  push.mostWork = hasShortLoops_ ? kMostLoops : 0;
  if (heavyWork() == kAnyWork) {
    push.heavy = 0;
    commands.dispatch(alone_, push, blocks(kSmallest) * kBlockSamples * maxSubgroup_);
  } else {
    aloneArguments_.record(commands, heavy_.address());
    aloneArguments_.dispatch(commands, alone_, push);
  }
}

}  // namespace raymap::vulkan
