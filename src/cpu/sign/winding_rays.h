#pragma once

#include "base/progress.h"
#include "cpu/sign/ray_sweep.h"

namespace raymap::cpu {

// Both functions return the number of samples whose six rays disagree, and report the part of the stage up to
// `end`. If the rays agree, the value is exactly their whole number.

/// Fills `winding` with the average of the six rays of each sample.
size_t averageRays(const RaySweep& sweep, Progress& progress, double end, Buffer<float>& winding);

/// Fills `winding` with each sample's ray along +x, the first of the paper's directions (Eq. 8, Fig. 5).
size_t takeOneRay(const RaySweep& sweep, Progress& progress, double end, Buffer<float>& winding);

}  // namespace raymap::cpu
