// Barill et al. 2018, "Fast winding numbers for soups and clouds", where Krayer & Müller 2019, §3.5, only
// sample.

#include "vulkan/stages/winding_dipoles.h"

#include <algorithm>

#include "shaders/winding_dipoles_doubts_spv.h"
#include "shaders/winding_dipoles_moments_spv.h"
#include "shaders/winding_dipoles_points_spv.h"
#include "shaders/winding_dipoles_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kMomentsGroup = 64;
constexpr uint32_t kPointsGroup = 64;
// Most loop iterations of an invocation in total. Mesa's software driver silently ends loops after 65,535.
constexpr uint32_t kFewTurns = 60000;
constexpr uint32_t kManyTurns = 60000000;
constexpr uint32_t kNumbersSettled = 2 * kLooks;  // Winding numbers per invocation: two samples, three times
                                                  // each.

uint64_t ceilDiv(uint64_t a, uint64_t b) {
  return (a + b - 1) / b;
}

uint64_t samplesOf(const glm::ivec3& dims) {
  return uint64_t(dims.x) * uint64_t(dims.y) * uint64_t(dims.z);
}

}  // namespace

WindingDipolesStage::WindingDipolesStage(Device& device)
    : gate_(device, "dispatches of the dipoles"),
      doubts_(device, shaders::kWindingDipolesDoubts,
              std::max(kDoubtsGroup, device.limits().maxSubgroupSize)),
      momentsOf_(device, shaders::kWindingDipolesMoments, kMomentsGroup),
      settle_(device, shaders::kWindingDipoles, kDoubtsGroup),
      points_(device, shaders::kWindingDipolesPoints, kPointsGroup),
      mostTurns_(device.info().type == DeviceType::Software ? kFewTurns : kManyTurns),
      moments_(device, "moments of the surface tree"),
      doubtful_(device, "doubtful samples") {}

void WindingDipolesStage::reserve(uint32_t triangleCount, const glm::ivec3& dims) {
  const std::vector<SurfaceTreeStage::Level> levels = SurfaceTreeStage::placeLevels(triangleCount);
  dims_ = dims;
  mostLevels_ = static_cast<uint32_t>(levels.size());
  moments_.resize<float>((uint64_t{levels[0].start} + levels[0].count) * kMomentVectors * 4);
  doubtful_.resize<uint32_t>(1);
  gate_.reserve(mostLevels_ + 1);
  for (uint32_t level = 0; level < mostLevels_; ++level)
    gate_.plan(level, ceilDiv(levels[level].count, kMomentsGroup));
  gate_.plan(mostLevels_, ceilDiv(samplesOf(dims), kDoubtsSamples));
}

WindingDipolesPush WindingDipolesStage::pushOf(const SurfaceTreeStage& tree, double threshold) const {
  return {.frames = tree.frames().address(),
          .discs = tree.discs().address(),
          .moments = moments_.address(),
          .gridX = static_cast<uint32_t>(dims_.x),
          .gridY = static_cast<uint32_t>(dims_.y),
          .gridZ = static_cast<uint32_t>(dims_.z),
          .triangleCount = tree.triangleCount(),
          .firstLeaf = tree.firstLeaf(),
          .threshold = static_cast<float>(threshold),
          .mostTurns = mostTurns_};
}

template <class Dispatch>
void WindingDipolesStage::recordMoments(const SurfaceTreeStage& tree, WindingDipolesPush push,
                                        Dispatch&& dispatch) {
  const std::vector<SurfaceTreeStage::Level>& levels = tree.levels();
  for (uint32_t level = 0; level < levels.size(); ++level) {
    push.levelStart = levels[level].start;
    push.levelCount = levels[level].count;
    push.isLeafLevel = level == 0 ? 1 : 0;
    dispatch(push, level);
  }
}

void WindingDipolesStage::record(Commands& commands, const SurfaceTreeStage& tree, const Fields& fields,
                                 double threshold) {
  WindingDipolesPush push = pushOf(tree, threshold);
  push.distance = fields.distance;
  push.winding = fields.winding;
  push.doubts = doubtful_.address();
  push.disagreeing = fields.disagreeing;
  push.mostTurns = mostTurns_ / kNumbersSettled;
  commands.fill(doubtful_, 0);
  commands.dispatch(doubts_, push, samplesOf(dims_));
  gate_.record(commands, doubtful_.address());
  recordMoments(tree, push, [&](const WindingDipolesPush& ofLevel, uint32_t level) {
    gate_.dispatch(commands, momentsOf_, ofLevel, level);
  });
  gate_.dispatch(commands, settle_, push, mostLevels_);
}

void WindingDipolesStage::recordNumbersAt(Commands& commands, const SurfaceTreeStage& tree,
                                          VkDeviceAddress points, uint32_t count, VkDeviceAddress numbers,
                                          double threshold) {
  WindingDipolesPush push = pushOf(tree, threshold);
  push.points = points;
  push.pointCount = count;
  push.winding = numbers;
  recordMoments(tree, push, [&](const WindingDipolesPush& ofLevel, uint32_t) {
    commands.dispatch(momentsOf_, ofLevel, ofLevel.levelCount);
  });
  commands.dispatch(points_, push, count);
}

}  // namespace raymap::vulkan
