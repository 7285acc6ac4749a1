#pragma once

// Small meshes with known answers.

#include <raymap/mesh.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace raymap::shapes {

/// Returns an axis-aligned box of 12 triangles.
inline Mesh box(glm::dvec3 low, glm::dvec3 high) {
  std::vector<glm::dvec3> p;
  for (int i = 0; i < 8; ++i)
    p.emplace_back(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
  return makeMesh(p, {{0, 2, 1},
                      {1, 2, 3},
                      {4, 5, 6},
                      {5, 7, 6},
                      {0, 1, 4},
                      {1, 5, 4},
                      {2, 6, 3},
                      {3, 6, 7},
                      {0, 4, 2},
                      {2, 4, 6},
                      {1, 3, 5},
                      {3, 7, 5}});
}

/// Returns an icosahedron subdivided `levels` times, with its vertices on the sphere.
inline Mesh sphere(double radius, int levels, glm::dvec3 centre = glm::dvec3(0.0)) {
  const double g = std::numbers::phi;
  std::vector<glm::dvec3> p{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                            {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<glm::uvec3> t{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                            {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                            {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                            {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [it, isNew] = middles.try_emplace(std::minmax(a, b), static_cast<uint32_t>(p.size()));
      if (isNew) p.push_back(0.5 * (glm::normalize(p[a]) + glm::normalize(p[b])));
      return it->second;
    };
    std::vector<glm::uvec3> finer;
    for (const glm::uvec3& f : t) {
      const uint32_t a = middle(f.x, f.y), b = middle(f.y, f.z), c = middle(f.z, f.x);
      finer.insert(finer.end(), {{f.x, a, c}, {f.y, b, a}, {f.z, c, b}, {a, b, c}});
    }
    t = std::move(finer);
  }
  for (glm::dvec3& v : p) v = centre + radius * glm::normalize(v);
  return makeMesh(p, std::move(t));
}

/// Returns a closed torus around z of n x m quads.
inline Mesh torus(double major, double minor, int n, int m) {
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
      const double r = major + minor * std::cos(v);
      p.emplace_back(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
      const auto at = [&](int a, int b) { return static_cast<uint32_t>((a % n) * m + b % m); };
      t.insert(t.end(),
               {{at(i, j), at(i + 1, j), at(i + 1, j + 1)}, {at(i, j), at(i + 1, j + 1), at(i, j + 1)}});
    }
  return makeMesh(p, std::move(t));
}

/// Returns `count` random triangles in the unit cube that share no vertices.
inline Mesh soup(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::dvec3> p(size_t(count) * 3);
  std::vector<glm::uvec3> t;
  for (glm::dvec3& v : p) v = {unit(random), unit(random), unit(random)};
  for (uint32_t i = 0; i < uint32_t(count); ++i) t.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  return makeMesh(p, std::move(t));
}

/// Returns the boundary of a set of cells, each `cell` wide: all vertices lie on samples, all faces pass
/// through samples.
inline Mesh voxels(const std::vector<glm::ivec3>& cells, int cell) {
  Mesh mesh;
  const auto filled = [&](glm::ivec3 c) { return std::find(cells.begin(), cells.end(), c) != cells.end(); };
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (const glm::ivec3& c : cells)
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        glm::ivec3 n(0), a(0), b(0);
        n[axis] = side ? 1 : -1;
        a[(axis + 1) % 3] = 1;
        b[(axis + 2) % 3] = 1;
        if (filled(c + n)) continue;
        if (!side) std::swap(a, b);
        glm::ivec3 corner = c;
        corner[axis] += side;
        const auto first = uint32_t(p.size());
        for (const glm::ivec3& q : {corner, corner + a, corner + a + b, corner + b})
          p.push_back(glm::dvec3(q * cell));
        t.insert(t.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
      }
  return makeMesh(p, std::move(t));
}

/// Returns both meshes in one.
inline Mesh joined(const Mesh& a, const Mesh& b) {
  std::vector<glm::dvec3> p;
  for (uint32_t v = 0; v < a.vertices.size(); ++v) p.push_back(a.position(v));
  for (uint32_t v = 0; v < b.vertices.size(); ++v) p.push_back(b.position(v));
  std::vector<glm::uvec3> t = a.triangles;
  for (const glm::uvec3& f : b.triangles) t.push_back(f + uint32_t(a.vertices.size()));
  return makeMesh(p, std::move(t));
}

/// Turns about an odd axis, so that nothing lies along the axes or a grid.
inline const glm::dmat3 kTurn(glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1.0, 2.0, 3.0))));

inline Mesh rotated(const Mesh& mesh) {
  std::vector<glm::dvec3> p;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) p.push_back(kTurn * mesh.position(v));
  return makeMesh(p, mesh.triangles);
}

/// Returns a mesh whose faces point to the other side.
inline Mesh inverted(Mesh mesh) {
  for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

}  // namespace raymap::shapes
