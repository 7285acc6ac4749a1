#pragma once

// Meshes broken on purpose, the same on every machine.

#include <raymap/mesh.h>

#include <algorithm>
#include <functional>
#include <random>
#include <utility>
#include <vector>

namespace raymap {

inline Mesh keepTriangles(const Mesh& mesh, const std::function<bool(const glm::uvec3&)>& keep) {
  Mesh result = mesh;
  std::erase_if(result.triangles, [&](const glm::uvec3& t) { return !keep(t); });
  return result;
}

/// Cuts round holes around random vertices; `radius` is a share of the diagonal.
inline Mesh withHoles(const Mesh& mesh, int count, double radius, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<glm::dvec3> centres;
  for (int h = 0; h < count; ++h) centres.push_back(mesh.position(random() % mesh.vertices.size()));
  const double reach = radius * glm::length(bounds(mesh).size());
  return keepTriangles(mesh, [&](const glm::uvec3& t) {
    const glm::dvec3 middle = (mesh.position(t.x) + mesh.position(t.y) + mesh.position(t.z)) / 3.0;
    return std::none_of(centres.begin(), centres.end(),
                        [&](const glm::dvec3& c) { return glm::length(middle - c) < reach; });
  });
}

inline Mesh withMissingFaces(const Mesh& mesh, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  return keepTriangles(mesh, [&](const glm::uvec3&) { return unit(random) >= share; });
}

inline Mesh withFlippedFaces(Mesh mesh, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (glm::uvec3& t : mesh.triangles)
    if (unit(random) < share) std::swap(t.y, t.z);
  return mesh;
}

}  // namespace raymap
