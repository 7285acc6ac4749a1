#pragma once

// Geometry of triangles. GPU twin: vulkan/stages/triangle.glsl, with the same names.

#include <algorithm>
#include <array>
#include <glm/glm.hpp>

namespace raymap::cpu {

inline float squaredLength(const glm::vec3& v) {
  return glm::dot(v, v);
}

/// Returns the squared distance from the origin to the segment from a to a + e, which may be a point.
inline float segmentSquaredDistance(const glm::vec3& a, const glm::vec3& e) {
  const float length2 = squaredLength(e);
  const float t = length2 > 0.0f ? std::clamp(-glm::dot(a, e) / length2, 0.0f, 1.0f) : 0.0f;
  return squaredLength(a + t * e);
}

/// Returns the squared distance from p to the triangle abc, which may be a segment or a point. Every
/// candidate is the distance to a point of the triangle, never to its plane. A sliver whose normal is mostly
/// rounding error is therefore never too close. Its edges keep it from being too far.
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
    // Except for slivers the projection is the closest point: the edges lie farther away.
    if (area2 > 1e-6f * squaredLength(ab) * squaredLength(ac)) return inside;
    return std::min({inside, segmentSquaredDistance(pa, ab), segmentSquaredDistance(pa, ac),
                     segmentSquaredDistance(b - p, c - b)});
  }
  return std::min(
      {segmentSquaredDistance(pa, ab), segmentSquaredDistance(pa, ac), segmentSquaredDistance(b - p, c - b)});
}

/// Bounds on a unit cube's centre: low <= dot(axis, centre) <= high if its projection on `axis` meets that of
/// the triangle.
struct Slab {
  glm::dvec3 axis;
  double low;
  double high;
};

/// Returns the separating axes of a triangle and a unit cube (Akenine-Möller 2001) as slabs that the cube's
/// centre must lie in. The cube's own normals are left out. The plane comes first, then the three edges for
/// each of x, y, z. `slack` enlarges the cube against rounding.
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
