#pragma once

// Meshes broken on purpose, the same on every machine.

#include <raymap/mesh_view.h>

#include <algorithm>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "testing/shapes.h"

namespace raymap {

inline Mesh keepTriangles(const Mesh& mesh, const std::function<bool(const glm::uvec3&)>& keep) {
  Mesh result = mesh;
  std::erase_if(result.triangles, [&](const glm::uvec3& t) { return !keep(t); });
  return result;
}

/// Removes the faces whose first corner lies above this height.
inline Mesh withoutCap(const Mesh& mesh, double height) {
  return keepTriangles(mesh, [&](const glm::uvec3& t) { return mesh.position(t.x).z <= height; });
}

inline Mesh holedSphere(int levels = 3) {
  return withoutCap(shapes::sphere(1.0, levels), 0.6);
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

/// Returns spheres of radius 1 in nearly one place, each without a tenth of its faces.
inline Mesh nearlyEqualShells(int count, int levels) {
  Mesh shells;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.004, 0.004);
  for (int i = 0; i < count; ++i) {
    const double x = shift(random), y = shift(random), z = shift(random);
    shells =
        shapes::joined(shells, withMissingFaces(shapes::sphere(1.0, levels, {x, y, z}), 0.1, unsigned(i)));
  }
  return shells;
}

inline Mesh withFlippedFaces(Mesh mesh, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (glm::uvec3& t : mesh.triangles)
    if (unit(random) < share) std::swap(t.y, t.z);
  return mesh;
}

/// Adds a copy that points the opposite way to a share of the faces.
inline Mesh withDoubledFaces(Mesh mesh, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const size_t count = mesh.triangles.size();
  for (size_t f = 0; f < count; ++f)
    if (const glm::uvec3 t = mesh.triangles[f]; unit(random) < share)
      mesh.triangles.emplace_back(t.z, t.y, t.x);
  return mesh;
}

/// Gives every face corners of its own and moves each of them by up to a share of the longest side.
inline Mesh withMovedCorners(const Mesh& mesh, double share, unsigned seed) {
  std::mt19937 random(seed);
  const glm::dvec3 size = bounds(mesh).size();
  const double reach = share * std::max({size.x, size.y, size.z});
  std::uniform_real_distribution<double> axis(-reach, reach);
  const auto move = [&] {
    for (;;)
      if (const glm::dvec3 v(axis(random), axis(random), axis(random)); glm::length(v) <= reach) return v;
  };
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> triangles;
  for (const glm::uvec3& t : mesh.triangles) {
    const auto first = static_cast<uint32_t>(p.size());
    for (int c = 0; c < 3; ++c) p.push_back(mesh.position(t[c]) + move());
    triangles.emplace_back(first, first + 1, first + 2);
  }
  return makeMesh(p, std::move(triangles));
}

}  // namespace raymap
