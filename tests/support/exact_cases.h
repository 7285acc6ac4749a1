#pragma once

// Meshes and grids for tests of the exact distance on any backend.

#include <raymap/grid.h>

#include <algorithm>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "reference.h"
#include "shapes.h"

namespace raymap {

struct ExactCase {
  std::string name;
  Mesh mesh;
  Grid grid;
};

/// Returns degenerate triangles along arbitrary lines: two corners are equal, or all lie on the line. Their
/// normals are rounding errors only.
inline Mesh linesAsTriangles() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<glm::dvec3> p{{-1, -1, -1}, {1, 1, 1}};  // Limits how far rounding moves the others.
  std::vector<glm::uvec3> triangles;
  for (uint32_t n = 0; n < 40; ++n) {
    const glm::dvec3 a(uniform(random), uniform(random), uniform(random));
    const glm::dvec3 b = a + 0.2 * glm::dvec3(uniform(random), uniform(random), uniform(random));
    p.insert(p.end(), {a, b, 0.5 * (a + b)});
    const uint32_t i = 3 * n + 2;
    const glm::uvec3 kinds[] = {{i, i + 1, i}, {i, i, i + 1}, {i, i + 1, i + 1}, {i, i + 1, i + 2}};
    triangles.push_back(kinds[n % 4]);
  }
  return makeMesh(p, triangles);
}

inline Mesh degenerateTriangles() {
  const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0, 1, 0}, {0, 1, 1e-12}, {1, 1, 1}};
  return makeMesh(p, {{0, 0, 0}, {0, 1, 2}, {3, 4, 5}, {5, 5, 1}, {2, 1, 0}});
}

/// Returns every shape at this resolution and at a very low one, boxes that cut or miss the mesh, degenerate
/// triangles, and meshes far from the origin.
inline std::vector<ExactCase> exactCases(int resolution) {
  std::vector<ExactCase> cases;
  const auto add = [&](const std::string& name, const Mesh& mesh, GridOptions options) {
    cases.push_back({name, mesh, fitGrid(mesh, options)});
  };
  const Mesh torus = shapes::torus(1.0, 0.3, 80, 40);
  const std::pair<const char*, Mesh> meshes[] = {
      {"box", shapes::box({0, 0, 0}, {1, 2, 3})},
      {"sphere", shapes::sphere(1.0, 4)},
      {"torus", torus},
      {"soup", shapes::soup(500, 1)},
      {"triangle", shapes::soup(1, 2)},
      {"two spheres", shapes::joined(shapes::sphere(1.0, 3), shapes::sphere(0.01, 4, {3, 0, 0}))},
      {"degenerate triangles", degenerateTriangles()},
      {"lines", linesAsTriangles()}};
  for (const auto& [name, mesh] : meshes) {
    add(name, mesh, {.resolution = resolution});
    add(std::string(name) + ", coarse", mesh, {.resolution = 5});
  }
  add("a box that cuts", torus, {.resolution = resolution, .box = Box{{0.5, 0.1, -0.2}, {1.9, 1.2, 0.6}}});
  add("a box that misses", torus, {.resolution = resolution, .box = Box{{3, 3, 3}, {4, 4.5, 3.7}}});
  Mesh far = torus;
  far.origin += glm::dvec3(1e6, -2e6, 3e6);
  add("far from the origin", far, {.resolution = resolution});
  return cases;
}

/// Compares a field with brute force at random samples. Returns the largest error over the diagonal of the
/// bounds, of the distance and of that to the closest triangle it names.
inline double largestExactError(const Mesh& mesh, const Grid& grid, std::span<const float> distance,
                                std::span<const uint32_t> triangle, int samples) {
  std::mt19937 random(7);
  double largest = 0.0;
  for (int n = 0; n < samples; ++n) {
    const glm::ivec3 s(random() % grid.dims.x, random() % grid.dims.y, random() % grid.dims.z);
    const glm::dvec3 p = grid.position(glm::dvec3(s));
    const double truth = reference::distance(mesh, p);
    const glm::uvec3 t = mesh.triangles.at(triangle[grid.index(s)]);
    const double named =
        reference::triangleDistance(p, mesh.position(t.x), mesh.position(t.y), mesh.position(t.z));
    largest = std::max({largest, std::abs(truth - distance[grid.index(s)]), std::abs(truth - named)});
  }
  return largest / glm::length(bounds(mesh).size());
}

}  // namespace raymap
