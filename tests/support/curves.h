#pragma once

// Crossings of axis-aligned curves with a mesh, straight from its triangles, in double precision. They owe
// nothing to the ray map.

#include <gtest/gtest.h>
#include <raymap/mesh.h>

#include <cmath>
#include <random>
#include <vector>

namespace raymap {

/// Returns triangles in a box of cells from `low` on, in cell units. All corners are odd multiples of 2^-11.
/// Single precision holds them exactly, and none lies on a lattice line.
inline Mesh exactSoup(int count, unsigned seed, const glm::ivec3& low, const glm::ivec3& size) {
  std::mt19937 random(seed);
  std::vector<glm::dvec3> p(size_t(count) * 3);
  std::vector<glm::uvec3> t;
  for (glm::dvec3& v : p)
    for (int c = 0; c < 3; ++c)
      v[c] = low[c] + double(random() % (1024u * size_t(size[c]))) / 1024.0 + 1.0 / 2048.0;
  for (uint32_t i = 0; i < uint32_t(count); ++i) t.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  return makeMesh(p, std::move(t));
}

class Curves {
 public:
  explicit Curves(const Mesh& mesh) {
    for (const glm::uvec3& t : mesh.triangles)
      triangles_.push_back({mesh.position(t.x), mesh.position(t.y), mesh.position(t.z)});
  }

  /// Returns the signed crossings on the way from a sample along `axis` to the coordinate `to`: +1 for each
  /// face that is left through its front.
  int segment(const glm::ivec3& from, int axis, double to) const {
    int sum = 0;
    for (const Triangle& triangle : triangles_) sum += crossing(triangle, from, axis, to);
    return sum;
  }

  /// Returns the sum of the six rays.
  int rays(const glm::ivec3& from) const {
    int sum = 0;
    for (int axis = 0; axis < 3; ++axis)
      sum += segment(from, axis, INFINITY) + segment(from, axis, -INFINITY);
    return sum;
  }

  /// Returns the sum of the paths between two samples, in the six orders of the axes.
  int paths(const glm::ivec3& from, const glm::ivec3& to) const {
    constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    int sum = 0;
    for (const auto& order : kOrders) {
      glm::ivec3 at = from;
      for (const int axis : order) {
        sum += segment(at, axis, to[axis]);
        at[axis] = to[axis];
      }
    }
    return sum;
  }

 private:
  struct Triangle {
    glm::dvec3 a, b, c;
  };

  static int crossing(const Triangle& triangle, const glm::dvec3& from, int axis, double to) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto side = [&](const glm::dvec3& p, const glm::dvec3& q) {  // Exact for `exactSoup`.
      return (p[u] - from[u]) * (q[v] - from[v]) - (p[v] - from[v]) * (q[u] - from[u]);
    };
    const double ab = side(triangle.a, triangle.b), bc = side(triangle.b, triangle.c),
                 ca = side(triangle.c, triangle.a);
    EXPECT_FALSE(ab == 0.0 || bc == 0.0 || ca == 0.0) << "an edge on a lattice line: choose another seed";
    const bool isFront = ab > 0.0;
    if ((bc > 0.0) != isFront || (ca > 0.0) != isFront) return 0;
    const double at =
        (bc * triangle.a[axis] + ca * triangle.b[axis] + ab * triangle.c[axis]) / (ab + bc + ca);
    EXPECT_GT(std::abs(at - std::round(at)), 1e-9) << "a sample on a face: choose another seed";
    if (to > from[axis]) return at > from[axis] && at < to ? (isFront ? 1 : -1) : 0;
    return at < from[axis] && at > to ? (isFront ? -1 : 1) : 0;
  }

  std::vector<Triangle> triangles_;
};

}  // namespace raymap
