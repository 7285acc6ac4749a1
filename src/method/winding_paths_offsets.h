#pragma once

#include <raymap/options.h>

#include "method/winding_paths_shared.h"

namespace raymap {

// Krayer & Müller 2019, §3.5, Eq. 9-11: the curves of a sample through offset points, on every backend.

inline constexpr int kRays = 6;

/// Returns the number of offset points of a pass of `Paths` or a step of `Evolution`.
int pointsPerPass(const FieldOptions& options);

/// Returns an offset point from the sample, in samples. `point` counts the points of all passes.
glm::ivec3 offsetOf(const FieldOptions& options, int64_t point, const glm::ivec3& dims);

}  // namespace raymap
