// Ours (Krayer & Müller 2019 keep the nearest cell's triangles, §3.3): the true closest triangle of every
// sample. As on the CPU, blocks of samples get lists of the nodes that may be closest to some sample in them.
// Here this takes three steps. A subgroup handles each block; its lanes are candidates first and samples at
// the end (docs/decisions/vulkan_exact_distance.md).

#include "vulkan/stages/exact_distance.h"

#include <raymap/field.h>

#include <algorithm>

#include "shaders/exact_distance_blocks_spv.h"
#include "shaders/exact_distance_rest_spv.h"
#include "shaders/exact_distance_spv.h"

namespace raymap::vulkan {

namespace {

static_assert(kNoneClosest == kNoTriangle);

/// Limits a group to four subgroups, each of which needs 4.6 KB of shared memory. In software it has one
/// subgroup: drivers may treat a subgroup's barrier as the group's (docs/decisions/vulkan_exact_distance.md).
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
      maxSubgroup_(device.limits().maxSubgroupSize),
      groupSize_(groupSizeOf(device, imitated.subgroups)),
      blocks_(device, shaders::kExactDistanceBlocks, groupSize_,
              {groupSize_ / device.limits().minSubgroupSize, static_cast<uint32_t>(imitated.rootError)}),
      samples_(device, shaders::kExactDistance, groupSize_,
               {groupSize_ / device.limits().minSubgroupSize, static_cast<uint32_t>(imitated.rootError)}),
      rest_(device, shaders::kExactDistanceRest, groupSize_,
            {groupSize_ / device.limits().minSubgroupSize, static_cast<uint32_t>(imitated.rootError)}),
      arguments_(device, "exact distance arguments", 1),
      lists_{DeviceBuffer(device, "lists of large blocks", scratch),
             DeviceBuffer(device, "lists of blocks", scratch)},
      unfinished_(device, "unfinished blocks") {}

void ExactDistanceStage::reserve(const glm::ivec3& dims) {
  dims_ = dims;
  for (uint32_t level = 0; level < kSmallest; ++level)
    lists_[level].resize<uint32_t>(blocks(level) * kListWords);
  if (hasShortLoops_) unfinished_.resize<uint32_t>(1 + blocks(kSmallest));
}

uint64_t ExactDistanceStage::blocks(uint32_t level) const {
  const uint64_t side = kSides[level];
  const glm::u64vec3 along = (glm::u64vec3(dims_) + (side - 1)) / side;
  return along.x * along.y * along.z;
}

ExactDistancePush ExactDistanceStage::pushOf(const SurfaceTreeStage& tree, const Fields& fields) const {
  return {.frames = tree.frames().address(),
          .discs = tree.discs().address(),
          .distance = fields.distance,
          .triangle = fields.triangle,
          .unfinished = unfinished_.address(),
          .dimX = static_cast<uint32_t>(dims_.x),
          .dimY = static_cast<uint32_t>(dims_.y),
          .dimZ = static_cast<uint32_t>(dims_.z),
          .firstLeaf = tree.firstLeaf(),
          .leafCount = tree.leafCount(),
          .tolerance = 1e-7f * glm::length(glm::vec3(dims_))};
}

void ExactDistanceStage::record(Commands& commands, const SurfaceTreeStage& tree, double band,
                                const Fields& fields) {
  ExactDistancePush push = pushOf(tree, fields);
  push.band = static_cast<float>(band);
  recordBlocks(commands, push);
}

void ExactDistanceStage::recordAddition(Commands& commands, const SurfaceTreeStage& tree,
                                        const Fields& fields) {
  ExactDistancePush push = pushOf(tree, fields);
  push.isAddition = 1;
  recordBlocks(commands, push);
}

void ExactDistanceStage::recordBlocks(Commands& commands, ExactDistancePush push) {
  commands.fill(unfinished_, 0);
  for (uint32_t level = 0; level <= kSmallest; ++level) {
    push.side = kSides[level];
    push.parents = level > 0 ? lists_[level - 1].address() : 0;
    push.blocksPerParent = level > 0 ? kSides[level - 1] / kSides[level] : 0;
    push.lists = level < kSmallest ? lists_[level].address() : 0;
    commands.dispatch(level < kSmallest ? blocks_ : samples_, push, blocks(level) * maxSubgroup_);
  }
  if (hasShortLoops_) recordRest(commands, push);
}

/// Finishes blocks that are unfinished because some drivers end loops too early. Those blocks test all
/// leaves, some in each pass.
void ExactDistanceStage::recordRest(Commands& commands, ExactDistancePush push) {
  const auto most = static_cast<uint32_t>(blocks(kSmallest));
  arguments_.record(commands, 0,
                    {.count = {.most = most, .address = unfinished_.address()},
                     .itemsPerGroup = groupSize_ / maxSubgroup_});
  for (; push.restLeaf < push.leafCount; push.restLeaf += kRestLeaves)
    arguments_.dispatch(commands, rest_, push, 0);
}

}  // namespace raymap::vulkan
