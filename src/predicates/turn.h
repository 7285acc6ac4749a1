#pragma once

// Which way three points of a plane turn.
//
// Precision: exact, for coordinates that are 0 or of a magnitude between 1e-140 and 1e150. Ties: points on a
// line turn by 0.

#include <glm/glm.hpp>

namespace raymap {

/// Returns 1 if the way from `a` over `b` to `c` turns counter-clockwise, -1 if clockwise, 0 if the three lie
/// on a line.
int turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c);

/// Returns twice the signed area of a triangle, rounded.
inline double doubleArea(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (a.x - c.x) * (b.y - c.y) - (a.y - c.y) * (b.x - c.x);
}

}  // namespace raymap
