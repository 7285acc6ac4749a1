#pragma once

#include <algorithm>
#include <glm/glm.hpp>

namespace raymap {

/// Returns the normal of a triangle, twice as long as its area.
inline glm::dvec3 doubleAreaNormal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::cross(b - a, c - a);
}

inline double triangleArea(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return 0.5 * glm::length(doubleAreaNormal(a, b, c));
}

/// Returns the normal of length 1, or 0 for a triangle without area.
inline glm::dvec3 unitNormal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 normal = doubleAreaNormal(a, b, c);
  const double length = glm::length(normal);
  return length > 0.0 ? normal / length : glm::dvec3(0.0);
}

template <class Scalar>
Scalar longestSide(const glm::vec<3, Scalar>& a, const glm::vec<3, Scalar>& b, const glm::vec<3, Scalar>& c) {
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

/// Returns the signed volume of the tetrahedron of a triangle and the origin: positive if the triangle is
/// counter-clockwise seen from outside.
inline double signedVolume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::dot(a, glm::cross(b, c)) / 6.0;
}

}  // namespace raymap
