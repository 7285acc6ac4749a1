#pragma once

// Geometry leaf functions; a GPU twin has the same names.

#include <algorithm>
#include <array>
#include <glm/glm.hpp>

namespace raymap::cpu {

inline float squaredLength(const glm::vec3& v) {
  return glm::dot(v, v);
}

/// Squared distance from the origin to the segment from a to a + e, which may be a point.
inline float segmentSquaredDistance(const glm::vec3& a, const glm::vec3& e) {
  const float length2 = squaredLength(e);
  const float t = length2 > 0.0f ? std::clamp(-glm::dot(a, e) / length2, 0.0f, 1.0f) : 0.0f;
  return squaredLength(a + t * e);
}

/// Squared distance from p to the triangle abc, which may be a segment or a point. Every candidate is the
/// distance to a point of the triangle, never to its plane: a sliver whose normal is mostly rounding cannot
/// come out too close, and its edges keep it from coming out too far.
inline float triangleSquaredDistance(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b,
                                     const glm::vec3& c) {
  const glm::vec3 pa = a - p, ab = b - a, ac = c - a;
  const glm::vec3 n = glm::cross(ab, ac);
  const float area2 = squaredLength(n);
  // Barycentric coordinates of the projection of p, times area2.
  const float v = glm::dot(glm::cross(ac, pa), n);
  const float w = glm::dot(glm::cross(pa, ab), n);
  if (v >= 0.0f && w >= 0.0f && v + w <= area2 && area2 > 0.0f) {
    const float inside = squaredLength(pa + (v / area2) * ab + (w / area2) * ac);
    // Short of slivers the projection is the answer: the edges lie farther away.
    if (area2 > 1e-6f * squaredLength(ab) * squaredLength(ac)) return inside;
    return std::min({inside, segmentSquaredDistance(pa, ab), segmentSquaredDistance(pa, ac),
                     segmentSquaredDistance(b - p, c - b)});
  }
  return std::min(
      {segmentSquaredDistance(pa, ab), segmentSquaredDistance(pa, ac), segmentSquaredDistance(b - p, c - b)});
}

/// low <= dot(axis, centre) <= high wherever a unit cube's shadow on `axis` meets the triangle's.
struct Slab {
  glm::dvec3 axis;
  double low;
  double high;
};

/// The separating axes of a triangle and a unit cube (Akenine-Möller 2001) but for the cube's own normals, as
/// slabs that the cube's centre must lie in: the plane first, then three edges by each of x, y, z. `slack`
/// widens the cube against rounding.
inline std::array<Slab, 10> triangleBoxSlabs(const std::array<glm::dvec3, 3>& corner, double slack) {
  const auto slab = [slack](const glm::dvec3& axis, double m0, double m1) {
    const double reach = (0.5 + slack) * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
    return Slab{axis, std::min(m0, m1) - reach, std::max(m0, m1) + reach};
  };
  std::array<Slab, 10> slabs;
  const glm::dvec3 normal = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  slabs[0] = slab(normal, glm::dot(normal, corner[0]), glm::dot(normal, corner[0]));
  for (int e = 0; e < 3; ++e) {
    const glm::dvec3& start = corner[e];
    const glm::dvec3& apex = corner[(e + 2) % 3];
    const glm::dvec3 edge = corner[(e + 1) % 3] - start;
    const std::array<glm::dvec3, 3> axes{
        {{0.0, edge.z, -edge.y}, {-edge.z, 0.0, edge.x}, {edge.y, -edge.x, 0.0}}};
    for (int u = 0; u < 3; ++u)
      slabs[1 + 3 * u + e] = slab(axes[u], glm::dot(axes[u], start), glm::dot(axes[u], apex));
  }
  return slabs;
}

}  // namespace raymap::cpu
