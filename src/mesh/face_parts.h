#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace raymap {

/// Most parts that the sides of a face are cut into.
inline constexpr double kMostFaceParts = 4096.0;

/// Returns the number of parts that each side of a triangle is cut into, so that none is longer than `step`.
inline int facePartsPerSide(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, double step) {
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  return static_cast<int>(std::clamp(std::ceil(longest / step), 1.0, kMostFaceParts));
}

/// Calls `visit(a, b, c)` with the corners of the parts of an evenly cut triangle. They wind as it does.
template <class Visit>
void forEachFacePart(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, int parts, Visit&& visit) {
  const glm::vec3 u = (b - a) / static_cast<float>(parts), v = (c - a) / static_cast<float>(parts);
  const auto at = [&](int i, int j) { return a + (static_cast<float>(i) * u + static_cast<float>(j) * v); };
  for (int j = 0; j < parts; ++j)
    for (int i = 0; i + j < parts; ++i) {
      visit(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i + j + 1 < parts) visit(at(i + 1, j + 1), at(i, j + 1), at(i + 1, j));
    }
}

}  // namespace raymap
