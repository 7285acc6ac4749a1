// Barill et al. 2018, "Fast winding numbers for soups and clouds", where Krayer & Müller 2019, §3.5, only
// sample.

#include "vulkan/stages/winding_dipoles.h"

#include <algorithm>
#include <stdexcept>

#include "base/ceil_div.h"
#include "method/cell_lattice.h"
#include "shaders/winding_dipoles_doubts_spv.h"
#include "shaders/winding_dipoles_moments_spv.h"
#include "shaders/winding_dipoles_points_spv.h"
#include "shaders/winding_dipoles_spv.h"
#include "vulkan/device/dispatch_limits.h"

namespace raymap::vulkan {

namespace {

static_assert(kSamplesPerListed <= kTreeArity);  // A group has an invocation for each of its samples.

constexpr uint32_t kDoubtsGroup = 128;
constexpr uint32_t kMomentsGroup = 64;
// Most turns of a group in total. Mesa's software driver silently ends loops after 65,535 iterations, and a
// turn has up to two: one in an inner loop, one in the outer.
constexpr uint32_t kFewTurns = 30000;
constexpr uint32_t kManyTurns = 60000000;

/// Returns the number of invocations that compute one winding number. On a card, twice as many take half as
/// many turns one after the other, but leave more of them idle at the root
/// (docs/dev/decisions/winding_dipoles.md).
uint32_t invocationsOf(const Device& device) {
  const uint32_t least = device.info().type == DeviceType::Software ? kTreeArity : 64;
  return std::max(least, device.limits().maxSubgroupSize);
}

}  // namespace

WindingDipolesStage::WindingDipolesStage(Device& device, ScratchMemory* scratch, uint32_t invocations)
    : invocations_(invocations > 0 ? invocations : invocationsOf(device)),
      gate_(device, "dispatches of the dipoles"),
      doubts_(device, shaders::kWindingDipolesDoubts,
              std::max(kDoubtsGroup, device.limits().maxSubgroupSize)),
      momentsOf_(device, shaders::kWindingDipolesMoments, kMomentsGroup),
      settle_(device, shaders::kWindingDipoles, invocations_, {invocations_}),
      points_(device, shaders::kWindingDipolesPoints, invocations_, {invocations_}),
      arguments_(device, "dispatches of doubtful samples"),
      mostTurns_(device.info().type == DeviceType::Software ? kFewTurns : kManyTurns),
      moments_(device, "moments of the surface tree"),
      doubtful_(device, "list of doubtful samples", scratch) {}

void WindingDipolesStage::reserve(uint32_t triangleCount, const glm::ivec3& dims) {
  const std::vector<SurfaceTreeStage::Level> levels = SurfaceTreeStage::placeLevels(triangleCount);
  if (levels.size() > kMostTreeLevels) throw std::logic_error("a tree of more levels than its stack holds");
  dims_ = dims;
  moments_.resize<float>((uint64_t{levels[0].start} + levels[0].count) * kMomentVectors * 4);
  doubtful_.resize<uint32_t>(1 + mostListed());
  arguments_.reserve({.most = static_cast<uint32_t>(mostListed())});
  std::vector<uint64_t> groups;
  for (const SurfaceTreeStage::Level& level : levels) groups.push_back(ceilDiv(level.count, kMomentsGroup));
  gate_.plan(groups);
}

uint64_t WindingDipolesStage::mostListed() const {
  return ceilDiv(CellLattice{dims_}.count(), kSamplesPerListed);
}

WindingDipolesPush WindingDipolesStage::pushOf(const SurfaceTreeStage& tree, double threshold) const {
  return {.frames = tree.frames().address(),
          .discs = tree.discs().address(),
          .moments = moments_.address(),
          .dims = glm::uvec3(dims_),
          .triangleCount = tree.triangleCount(),
          .firstLeaf = tree.firstLeaf(),
          .threshold = static_cast<float>(threshold),
          .mostTurns = mostTurns_};
}

void WindingDipolesStage::recordMoments(Commands& commands, const SurfaceTreeStage& tree,
                                        WindingDipolesPush push, bool isGated) {
  const std::vector<SurfaceTreeStage::Level>& levels = tree.levels();
  for (uint32_t level = 0; level < levels.size(); ++level) {
    push.levelStart = levels[level].start;
    push.levelCount = levels[level].count;
    if (isGated)
      gate_.dispatch(commands, momentsOf_, push, level);
    else
      commands.dispatch(momentsOf_, push, push.levelCount);
  }
}

void WindingDipolesStage::record(Commands& commands, const SurfaceTreeStage& tree, const Fields& fields,
                                 Looks looks, double threshold) {
  WindingDipolesPush push = pushOf(tree, threshold);
  push.distance = fields.distance;
  push.winding = fields.winding;
  push.doubts = doubtful_.address();
  push.disagreeing = fields.disagreeing;
  push.change = fields.change;
  push.looks = looks.most;
  push.rimsDecide = looks.rimsDecide ? 1 : 0;
  push.mostListed = static_cast<uint32_t>(mostListed());
  commands.fill(doubtful_, 0);
  commands.dispatch(doubts_, push, ceilDiv(CellLattice{dims_}.count(), kDoubtsEach));
  commands.concurrent([&] {
    gate_.record(commands, doubtful_.address());
    arguments_.record(commands, doubtful_.address());
  });
  recordMoments(commands, tree, push, true);
  // One group for each sample, or for some samples if the list does not hold all of them.
  arguments_.dispatch(commands, settle_, push);
}

void WindingDipolesStage::recordNumbersAt(Commands& commands, const SurfaceTreeStage& tree,
                                          VkDeviceAddress points, uint32_t count, VkDeviceAddress numbers,
                                          double threshold) {
  WindingDipolesPush push = pushOf(tree, threshold);
  push.points = points;
  push.pointCount = count;
  push.winding = numbers;
  recordMoments(commands, tree, push, false);
  commands.dispatch(points_, push, uint64_t{count} * invocations_);
}

}  // namespace raymap::vulkan
