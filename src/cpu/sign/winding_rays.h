#pragma once

#include "base/progress.h"
#include "cpu/sign/ray_sweep.h"

namespace raymap::cpu {

/// Fills `winding` with the average of the six rays of each sample. Returns the number of samples whose rays
/// disagree. If they agree, the value is exactly their whole number.
size_t averageRays(const RaySweep& sweep, Buffer<float>& winding);

}  // namespace raymap::cpu
