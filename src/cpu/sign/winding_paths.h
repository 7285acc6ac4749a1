#pragma once

#include <raymap/generate.h>

#include "base/progress.h"
#include "cpu/sign/ray_sweep.h"

namespace raymap::cpu {

// Both start from the six-ray average in `winding` and replace it. `scratch` keeps their memory.

struct PathScratch {
  std::array<Buffer<int32_t>, 3> rays;  ///< r of every sample.
  Buffer<float> next;

  size_t bytes() const;
};

/// §3.5, Eq. 9, the paper's simpler technique: P passes, each with one offset point q, the six paths to it
/// along the axes, and its six rays.
void averagePaths(const RaySweep& sweep, const Options& options, Progress& progress, PathScratch& scratch,
                  Buffer<float>& winding);

/// §3.5, Eq. 10-11: P steps, each with four offset points, on the field that the step before left.
void evolvePaths(const RaySweep& sweep, const Options& options, Progress& progress, PathScratch& scratch,
                 Buffer<float>& winding);

}  // namespace raymap::cpu
