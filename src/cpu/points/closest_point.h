#pragma once

#include <glm/glm.hpp>

namespace raymap::cpu {

/// Point of a triangle: the sum of the corners times `weights`.
struct TrianglePoint {
  glm::dvec3 position, weights;
};

/// Returns the point of a triangle that is closest to p. The triangle may be a segment or a point.
TrianglePoint closestPoint(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                           const glm::dvec3& c);

}  // namespace raymap::cpu
