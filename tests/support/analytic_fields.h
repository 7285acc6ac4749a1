#pragma once

// Fields whose distance is a formula.

#include <raymap/field.h>

#include <algorithm>
#include <cmath>

namespace raymap::analytic {

/// `distance(position)` at every sample of the grid.
template <class Distance>
Field sampled(const Grid& grid, Distance&& distance) {
  Field field;
  field.grid = grid;
  field.distance.resizeUninitialized(grid.sampleCount());
  for (int k = 0; k < grid.dims.z; ++k)
    for (int j = 0; j < grid.dims.y; ++j)
      for (int i = 0; i < grid.dims.x; ++i)
        field.distance[grid.index({i, j, k})] = float(distance(grid.position({i, j, k})));
  return field;
}

/// n x n x n samples over the cube from -side/2 to side/2.
inline Grid cube(int n, double side) {
  const double spacing = side / n;
  return {glm::ivec3(n), glm::dvec3(0.5 * (spacing - side)), spacing};
}

inline double sphere(const glm::dvec3& p, double radius) {
  return glm::length(p) - radius;
}

inline double torus(const glm::dvec3& p, double major, double minor) {
  return std::hypot(std::hypot(p.x, p.z) - major, p.y) - minor;
}

inline double box(const glm::dvec3& p, const glm::dvec3& half) {
  const glm::dvec3 q = glm::abs(p) - half;
  return glm::length(glm::max(q, 0.0)) + std::min(std::max({q.x, q.y, q.z}), 0.0);
}

/// A box with one round corner, which tells its sides apart.
inline double notchedBox(const glm::dvec3& p) {
  return std::max(box(p, {0.7, 0.5, 0.6}), -sphere(p - glm::dvec3(0.4, 0.5, 0.6), 0.45));
}

}  // namespace raymap::analytic
