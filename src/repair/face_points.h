#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

namespace raymap {

/// Visits the middles of the parts of an evenly cut segment.
template <class Visit>
void forEachEdgePoint(const glm::dvec3& a, const glm::dvec3& b, int parts, Visit&& visit) {
  for (int k = 0; k < parts; ++k) visit(glm::mix(a, b, (k + 0.5) / parts));
}

/// Returns the number of parts, at least 1, into which a length must be cut so that none exceeds `step`.
inline int partsOf(double length, double step) {
  return static_cast<int>(std::clamp(std::ceil(length / step), 1.0, 1e6));
}

/// Visits points on a triangle, in rows along its longest edge. Neighbours are at most `step` apart, and the
/// number of points is about the area in squares of it.
template <class Visit>
void forEachFacePoint(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double step,
                      Visit&& visit) {
  std::array<glm::dvec3, 3> p{a, b, c};
  const auto length = [&](size_t k) { return glm::distance(p[k], p[(k + 1) % 3]); };
  size_t longest = 0;
  for (size_t k = 1; k < 3; ++k)
    if (length(k) > length(longest)) longest = k;
  std::rotate(p.begin(), p.begin() + ptrdiff_t(longest), p.end());
  const double base = glm::distance(p[0], p[1]);
  const double height = base > 0.0 ? glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) / base : 0.0;
  const int rows = partsOf(height, step);
  for (int row = 0; row < rows; ++row) {
    const double up = (row + 0.5) / rows;
    forEachEdgePoint(glm::mix(p[0], p[2], up), glm::mix(p[1], p[2], up), partsOf(base * (1.0 - up), step),
                     visit);
  }
}

}  // namespace raymap
