#pragma once

// Brute-force references in double precision, independent of the code under test.

#include <raymap/mesh.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raymap::reference {

inline double segmentDistance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 e = b - a;
  const double length2 = glm::dot(e, e);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, e) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - (a + t * e));
}

/// Returns the distance from p to the triangle abc, which may be degenerate.
inline double triangleDistance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                               const glm::dvec3& c) {
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double edges =
      std::min({segmentDistance(p, a, b), segmentDistance(p, b, c), segmentDistance(p, c, a)});
  const double area = glm::length(n);
  // Where rounding decides the normal's direction, every point of the triangle is close to an edge.
  const double longest2 = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  if (!(area > 1e-8 * longest2)) return edges;
  const bool inside = glm::dot(glm::cross(n, b - a), p - a) >= 0.0 &&
                      glm::dot(glm::cross(n, c - b), p - b) >= 0.0 &&
                      glm::dot(glm::cross(n, a - c), p - c) >= 0.0;
  return inside ? std::min(edges, std::abs(glm::dot(n, p - a)) / area) : edges;
}

/// Returns the distance from p to the closest triangle.
inline double distance(const Mesh& mesh, const glm::dvec3& p) {
  double closest = INFINITY;
  for (const glm::uvec3& t : mesh.triangles)
    closest =
        std::min(closest, triangleDistance(p, mesh.position(t.x), mesh.position(t.y), mesh.position(t.z)));
  return closest;
}

/// Returns the exact generalized winding number (Jacobson et al. 2013; solid angles by Van Oosterom &
/// Strackee 1983). It is +1 inside a closed surface whose faces point outwards.
inline double windingNumber(const Mesh& mesh, const glm::dvec3& p) {
  double angle = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.position(t.x) - p, b = mesh.position(t.y) - p, c = mesh.position(t.z) - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double numerator = glm::dot(a, glm::cross(b, c));
    const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    angle += 2.0 * std::atan2(numerator, denominator);
  }
  return angle / (4.0 * std::numbers::pi);
}

}  // namespace raymap::reference
