// Krayer & Müller 2019, §3.5. Paper: the mean over sampled curves (Eq. 9-11). Here: the limit of that mean,
// by full multigrid, as on the CPU. If all rays agree, the device skips the work without asking the host.

#include "vulkan/stages/winding_harmonic.h"

#include <algorithm>

#include "base/ceil_div.h"
#include "shaders/winding_harmonic_coarse_spv.h"
#include "shaders/winding_harmonic_correct_spv.h"
#include "shaders/winding_harmonic_prolong_spv.h"
#include "shaders/winding_harmonic_relax_spv.h"
#include "shaders/winding_harmonic_restrict_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kRestrictGroup = kRestrictX * kRestrictY * kRestrictZ;
constexpr uint32_t kMostCoarseGroup = 1024;
constexpr double kRestrictShare = 0.125;  // Samples of the next coarser lattice per sample.

uint64_t restrictGroups(const glm::ivec3& coarse) {
  return ceilDiv(uint64_t(coarse.x), kRestrictX) * ceilDiv(uint64_t(coarse.y), kRestrictY) *
         ceilDiv(uint64_t(coarse.z), kRestrictZ);
}

}  // namespace

WindingHarmonicStage::WindingHarmonicStage(Device& device, ScratchMemory* scratch)
    : device_(&device),
      scratch_(scratch),
      gate_(device, "dispatches of the harmonic solve"),
      relax_(device, shaders::kWindingHarmonicRelax, kGroup),
      restrict_(device, shaders::kWindingHarmonicRestrict, kRestrictGroup),
      correct_(device, shaders::kWindingHarmonicCorrect, kGroup),
      prolong_(device, shaders::kWindingHarmonicProlong, kGroup),
      coarse_(device, shaders::kWindingHarmonicCoarse, std::min(kMostCoarseGroup, device.limits().groupSize),
              {kCoarsestSweeps, 0, 1}) {}

void WindingHarmonicStage::reserve(const glm::ivec3& dims) {
  const auto count = static_cast<size_t>(coarsestHarmonicLevel(dims)) + 1;
  while (levels_.size() > count) levels_.pop_back();
  while (levels_.size() < count)
    levels_.push_back({.values = {*device_, "winding values", scratch_},
                       .rightHandSide = {*device_, "right-hand side of winding", scratch_}});
  for (size_t l = 0; l < count; ++l) {
    Level& level = levels_[l];
    level.box = harmonicBox(dims, int(l));
    if (l == 0) continue;
    // The coarsest lattice's values are shared memory. Its buffer holds the residuals of the next finer one.
    level.values.resize<float>(levels_[std::min(l, count - 2)].box.sampleCount());
    level.rightHandSide.resize<float>(level.box.sampleCount());
  }
  dims_ = dims;
  plan();
}

void WindingHarmonicStage::plan() {
  double cycle = 0.0;  // Samples that a V-cycle visits: relaxed twice, corrected, restricted.
  work_ = 0.0;
  for (uint32_t l = coarse(); l-- > 0;) {
    const auto samples = double(levels_[l].box.sampleCount());
    cycle += (3.0 + kRestrictShare) * samples;
    work_ += cycle + samples;  // Prolonged before.
  }
  std::vector<uint64_t> groups;
  for (uint32_t l = 0; l < levels_.size(); ++l) {
    const LatticeBox& box = levels_[l].box;
    const uint64_t half = uint64_t(box.dims.x + 1) / 2 * uint64_t(box.dims.y) * uint64_t(box.dims.z);
    for (const uint64_t count : {ceilDiv(box.sampleCount(), kGroup), ceilDiv(half, kGroup),
                                 l < coarse() ? restrictGroups(levels_[l + 1].box.dims) : 1, uint64_t{1}})
      groups.push_back(count);  // In the order of `Extent`.
  }
  gate_.plan(groups, kMostGroups);
}

/// Solves by full multigrid: each lattice starts from the solution on the next coarser one. One V-cycle then
/// leaves an error below that of the lattice itself (docs/signs.md).
void WindingHarmonicStage::record(Commands& commands, const WindingFields& fields) {
  gate_.record(commands, fields.doubtful);
  done_ = 0.0;
  solveCoarse(commands, fields, 0);
  for (uint32_t l = coarse(); l-- > 0;) {
    dispatch(commands, prolong_, push(fields, l), Extent::Samples);
    improve(commands, fields, l, 0);
  }
}

/// Runs a V-cycle: the error that remains after relaxing is smooth, so the coarser lattice resolves it, and
/// it has no jumps. On that lattice it begins with the second colour, as restricting has relaxed the first.
void WindingHarmonicStage::improve(Commands& commands, const WindingFields& fields, uint32_t level,
                                   uint32_t firstColour) {
  WindingHarmonicPush fine = push(fields, level);
  if (firstColour > 0) fine.rightHandSide = levels_[level].rightHandSide.address();
  relax(commands, fine, firstColour);
  dispatch(commands, restrict_, fine, Extent::RestrictGroups);
  if (level + 1 == coarse())
    solveCoarse(commands, fields, 1);
  else
    improve(commands, fields, level + 1, 1);
  dispatch(commands, correct_, fine, Extent::Samples);
  relax(commands, fine, 0);
}

void WindingHarmonicStage::relax(Commands& commands, WindingHarmonicPush push, uint32_t firstColour) {
  for (push.colour = firstColour; push.colour < 2; ++push.colour)
    dispatch(commands, relax_, push, Extent::HalfSamples);
}

/// Solves the two coarsest lattices, or runs a V-cycle on them.
void WindingHarmonicStage::solveCoarse(Commands& commands, const WindingFields& fields,
                                       uint32_t firstColour) {
  WindingHarmonicPush both = push(fields, coarse());
  both.rightHandSide = levels_[coarse()].rightHandSide.address();
  both.colour = firstColour;
  both.factor = overrelaxation(levels_.back().box.dims);
  dispatch(commands, coarse_, both, Extent::OneGroup);
}

WindingHarmonicPush WindingHarmonicStage::push(const WindingFields& fields, uint32_t level) const {
  return {.rays = {fields.rays[0], fields.rays[1], fields.rays[2]},
          .values = level == 0 ? fields.winding : levels_[level].values.address(),
          .coarse = levels_[level + 1].values.address(),
          .coarseEquations = levels_[level + 1].rightHandSide.address(),
          .dims = glm::uvec3(dims_),
          .level = level};
}

void WindingHarmonicStage::dispatch(Commands& commands, Kernel<WindingHarmonicPush>& kernel,
                                    const WindingHarmonicPush& push, Extent extent) {
  gate_.dispatch(commands, kernel, push, push.level * kExtents + static_cast<uint32_t>(extent));
  report(commands, push.level, extent);
}

/// Reports the work on the two finest lattices, which is most of it. The rays before it are taken as a fifth
/// of the stage, as on the CPU.
void WindingHarmonicStage::report(Commands& commands, uint32_t level, Extent extent) {
  constexpr double kShares[kExtents] = {1.0, 0.5, kRestrictShare, 0.0};
  constexpr double kRays = 0.2;
  done_ += kShares[static_cast<uint32_t>(extent)] * double(levels_[level].box.sampleCount());
  if (level <= 1) commands.report(kRays + (1.0 - kRays) * std::min(done_ / work_, 1.0));
}

}  // namespace raymap::vulkan
