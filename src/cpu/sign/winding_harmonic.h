#pragma once

#include "base/progress.h"
#include "cpu/sign/winding_harmonic_jumps.h"

namespace raymap::cpu {

/// One lattice of the hierarchy: its field, the jumps at its edges, and the correction that it computes for
/// the next finer lattice.
struct HarmonicLevel {
  LatticeBox box;
  std::array<JumpRows, 3> jumps;
  // Empty on the finest level, whose field is the result.
  Buffer<float> values;
  Buffer<float> correction;
  Buffer<float> residual;
};

struct HarmonicScratch {
  std::vector<HarmonicLevel> levels;

  size_t bytes() const;
  /// Returns about how many bytes it holds after a run on this map.
  static size_t bytesNeeded(const RayMap& map);
};

/// Fills `winding` with the field that meets w(i) - w(i + 1) = w_l(i) on all lattice edges as well as
/// possible, in the least-squares sense. The field vanishes far away. Reports the part of the stage from
/// `begin` on.
void solveHarmonic(const RayMap& map, Progress& progress, double begin, HarmonicScratch& scratch,
                   Buffer<float>& winding);

}  // namespace raymap::cpu
