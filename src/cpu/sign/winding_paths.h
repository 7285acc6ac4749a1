#pragma once

#include <raymap/options.h>

#include "base/progress.h"
#include "cpu/sign/ray_sweep.h"

namespace raymap::cpu {

// `averagePaths` and `evolvePaths` start from the six-ray average in `winding` and replace it. They report
// the part of the stage from `begin` on.

/// Memory that both keep between runs.
struct PathScratch {
  std::array<Buffer<int32_t>, 3> rays;  ///< r of every sample.
  Buffer<float> next;

  size_t bytes() const;
  /// Returns the bytes that it holds after a run on so many samples.
  static size_t bytesNeeded(size_t samples);
};

/// Averages over P passes (§3.5, Eq. 9), the paper's simpler technique. Each offset point q of a pass has the
/// six paths to it along the axes, and its six rays.
void averagePaths(const RaySweep& sweep, const FieldOptions& options, Progress& progress, double begin,
                  PathScratch& scratch, Buffer<float>& winding);

/// Evolves the field in P steps (§3.5, Eq. 10-11). Each step has several offset points and starts from the
/// field of the previous step.
void evolvePaths(const RaySweep& sweep, const FieldOptions& options, Progress& progress, double begin,
                 PathScratch& scratch, Buffer<float>& winding);

}  // namespace raymap::cpu
