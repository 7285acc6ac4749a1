#pragma once

// A segment and a triangle.
//
// Precision: double, with a bound on rounding.
// Ties: none are broken. What rounding could change is `kUnsure`.

#include <cstdint>
#include <glm/glm.hpp>

namespace raymap {

/// Stands for a number of crossings that rounding errors could change.
inline constexpr int32_t kUnsure = INT32_MIN;

/// Returns by how much the winding number changes where the segment crosses a triangle: by +1 through its
/// front, by -1 through its back. `kUnsure` where the segment meets an edge, or an end lies in the plane.
int32_t crossSegment(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& from,
                     const glm::dvec3& to);

}  // namespace raymap
