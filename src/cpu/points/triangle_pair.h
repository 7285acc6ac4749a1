#pragma once

#include <array>
#include <glm/glm.hpp>

namespace raymap::cpu {

using Corners = std::array<glm::dvec3, 3>;

/// A point of each of two triangles, and their squared distance.
struct TrianglePair {
  double squared;
  glm::dvec3 a, b;
};

/// Returns the closest points of two triangles, which may be segments or points: 0 apart where the edge of
/// one crosses the other, unless they are known not to cross. Precision: double.
TrianglePair closestPoints(const Corners& a, const Corners& b, bool mayCross);

}  // namespace raymap::cpu
