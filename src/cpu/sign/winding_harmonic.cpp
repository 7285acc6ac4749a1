// Krayer & Müller 2019, §3.5. Paper: the mean over sampled curves (Eq. 9-11). Here: the limit of that idea
// (docs/signs.md). The field's differences along all lattice edges come as close as possible to their
// crossing counts (Eq. 5).

#include "cpu/sign/winding_harmonic.h"

#include <algorithm>

#include "cpu/sign/winding_harmonic_transfer.h"

namespace raymap::cpu {

namespace {

class Hierarchy {
 public:
  Hierarchy(std::vector<HarmonicLevel>& levels, WorkMeter& meter, Buffer<float>& winding)
      : levels_(levels), meter_(meter), winding_(winding) {}

  /// Solves lattice `l` by full multigrid, starting from the solution on the next coarser one. One V-cycle
  /// then leaves an error below that of the lattice itself (docs/signs.md). More cycles would only cost more.
  void solve(size_t l) {
    HarmonicLevel& level = levels_[l];
    float* values = l == 0 ? winding_.data() : level.values.data();
    const RightHandSide jumps{.jumps = &level.jumps};
    if (isCoarsest(l)) {
      std::fill_n(values, level.box.sampleCount(), 0.0f);
      overrelaxField(level.box, jumps, kCoarsestSweeps, values);
      return;
    }
    prolongField(levels_[l + 1].box, levels_[l + 1].values.data(), level.box, level.jumps, meter_, values);
    improve(l, jumps, values);
  }

 private:
  bool isCoarsest(size_t l) const { return l + 1 == levels_.size(); }

  /// Runs a V-cycle. The error that is left after relaxing is smooth and has no jumps, so the coarser lattice
  /// can correct it.
  void improve(size_t l, const RightHandSide& rightHandSide, float* values) {
    const LatticeBox& box = levels_[l].box;
    HarmonicLevel& coarse = levels_[l + 1];
    relaxField(box, rightHandSide, meter_, values);
    restrictResidual(box, rightHandSide, values, coarse.box, meter_, coarse.residual.data());
    const RightHandSide residual{.values = coarse.residual.data()};
    float* correction = coarse.correction.data();
    std::fill_n(correction, coarse.box.sampleCount(), 0.0f);
    if (isCoarsest(l + 1))
      overrelaxField(coarse.box, residual, kCoarsestSweeps, correction);
    else
      improve(l + 1, residual, correction);
    addCorrection(coarse.box, correction, box, meter_, values);
    relaxField(box, rightHandSide, meter_, values);
  }

  std::vector<HarmonicLevel>& levels_;
  WorkMeter& meter_;
  Buffer<float>& winding_;
};

void buildLevel(const RayMap& map, size_t l, HarmonicLevel& level) {
  level.box = harmonicBox(map.dims, int(l));
  for (int axis = 0; axis < 3; ++axis) level.jumps[size_t(axis)].collect(map, level.box, axis);
  if (l == 0) return;
  for (Buffer<float>* field : {&level.values, &level.correction, &level.residual})
    field->resizeUninitialized(level.box.sampleCount());
}

/// Returns the number of samples that `solveHarmonic` visits, each time that it does. A level is prolonged to
/// once. The V-cycle of each finer level and its own pass through it, with four visits.
double samplesToVisit(const glm::ivec3& dims) {
  double visits = 0.0;
  for (int l = 0; l < coarsestHarmonicLevel(dims); ++l)
    visits += double(harmonicBox(dims, l).sampleCount()) * (1.0 + 4.0 * (l + 1));
  return visits;
}

}  // namespace

size_t HarmonicScratch::bytes() const {
  size_t sum = 0;
  for (const HarmonicLevel& level : levels) {
    sum += level.values.capacityBytes() + level.correction.capacityBytes() + level.residual.capacityBytes();
    for (const JumpRows& jumps : level.jumps) sum += jumps.bytes();
  }
  return sum;
}

size_t HarmonicScratch::bytesNeeded(const RayMap& map) {
  size_t sum = 0;
  for (int l = 0; l <= coarsestHarmonicLevel(map.dims); ++l) {
    const LatticeBox box = harmonicBox(map.dims, l);
    if (l > 0) sum += 3 * sizeof(float) * box.sampleCount();
    for (const RayMap::Axis& axis : map.axes) sum += JumpRows::bytesNeeded(box, axis.steps.size());
  }
  return sum;
}

void solveHarmonic(const RayMap& map, Progress& progress, double begin, HarmonicScratch& scratch,
                   Buffer<float>& winding) {
  scratch.levels.resize(size_t(coarsestHarmonicLevel(map.dims)) + 1);
  WorkMeter meter(progress, begin, 1.0, samplesToVisit(map.dims));
  Hierarchy hierarchy(scratch.levels, meter, winding);
  for (size_t l = scratch.levels.size(); l-- > 0;) {
    buildLevel(map, l, scratch.levels[l]);
    hierarchy.solve(l);
  }
}

}  // namespace raymap::cpu
