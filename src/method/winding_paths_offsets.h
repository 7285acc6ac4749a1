#pragma once

#include <raymap/generate.h>

namespace raymap {

// Krayer & Müller 2019, §3.5, Eq. 9-11: the curves of a sample by way of offset points, on every backend.

inline constexpr int kPathsPerPoint = 6;  // xyz, xzy, yxz, yzx, zxy, zyx
inline constexpr int kRays = 6;
// Offset points of one step of the evolution. With a single one the field would nearly be that point's.
inline constexpr int kPointsPerStep = 4;

/// The offset point of a pass, in samples.
glm::ivec3 offsetOf(const Options& options, int64_t pass, const glm::ivec3& dims);

}  // namespace raymap
