#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

namespace raymap {

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
  const double rows = std::max(std::ceil(height / step), 1.0);
  for (double row = 0.5; row < rows; row += 1.0) {
    const double up = row / rows, width = base * (1.0 - up);
    const glm::dvec3 left = glm::mix(p[0], p[2], up), right = glm::mix(p[1], p[2], up);
    const double columns = std::max(std::ceil(width / step), 1.0);
    for (double column = 0.5; column < columns; column += 1.0) visit(glm::mix(left, right, column / columns));
  }
}

}  // namespace raymap
