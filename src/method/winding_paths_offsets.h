#pragma once

#include <raymap/generate.h>

namespace raymap {

// Krayer & Müller 2019, §3.5, Eq. 9-11: the curves of a sample through offset points, on every backend.

inline constexpr int kPathsPerPoint = 6;  // xyz, xzy, yxz, yzx, zxy, zyx
inline constexpr int kRays = 6;
// Number of offset points per step of the evolution. With one point the field would nearly be that point's.
inline constexpr int kPointsPerStep = 4;

/// Returns the offset of a pass's point from the sample, in samples.
glm::ivec3 offsetOf(const Options& options, int64_t pass, const glm::ivec3& dims);

}  // namespace raymap
