#pragma once

#include <glm/glm.hpp>

namespace raymap {

/// Returns the normal of a triangle, twice as long as its area.
inline glm::dvec3 doubleAreaNormal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::cross(b - a, c - a);
}

inline double triangleArea(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return 0.5 * glm::length(doubleAreaNormal(a, b, c));
}

}  // namespace raymap
