#pragma once

// Random points around a mesh, the same on every machine.

#include <raymap/grid.h>
#include <raymap/mesh.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace raymap {

/// Returns points in the mesh's box, padded by this share of its longest side.
inline std::vector<glm::dvec3> uniformPoints(const Mesh& mesh, size_t count, double padding = 0.1) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Box box = bounds(mesh);
  const double more = padding * std::max({box.size().x, box.size().y, box.size().z});
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points)
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = box.min[axis] - more + unit(random) * (box.size()[axis] + 2.0 * more);
  return points;
}

/// Returns points up to `reach` diagonals from random points of random triangles.
inline std::vector<glm::dvec3> nearPoints(const Mesh& mesh, size_t count, double reach) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const double most = reach * glm::length(bounds(mesh).size());
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points) {
    const glm::uvec3& t = mesh.triangles[random() % mesh.triangles.size()];
    const double s = std::sqrt(unit(random)), r = unit(random);
    const double height = 2.0 * unit(random) - 1.0, angle = 6.283185307179586 * unit(random);
    const double flat = std::sqrt(1.0 - height * height), length = most * unit(random);
    p = (1.0 - s) * mesh.position(t.x) + s * (1.0 - r) * mesh.position(t.y) + s * r * mesh.position(t.z) +
        length * glm::dvec3(flat * std::cos(angle), flat * std::sin(angle), height);
  }
  return points;
}

}  // namespace raymap
