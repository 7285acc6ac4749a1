#pragma once

#include <raymap/grid.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace raymap::cpu {

/// Points farther from a grid than this many times its size are moved closer, to this distance, at which the
/// two directions differ too little to matter.
inline constexpr float kFarthest = 1e4f;

inline double largestOf(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Returns the factor by which an offset shrinks so that its square does not overflow; 1 for most.
inline double shrinkingOf(const glm::dvec3& offset) {
  constexpr double kSafe = 1e150;
  const double largest = largestOf(offset);
  return largest > kSafe ? kSafe / largest : 1.0;
}

inline bool isFinite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Returns a point in the cells of a grid.
inline glm::vec3 toCells(const Grid& grid, const glm::dvec3& p) {
  if (!isFinite(p)) return glm::vec3(NAN);
  const glm::dvec3 offset = p - grid.origin;
  glm::dvec3 q = offset * shrinkingOf(offset) * (1.0 / grid.spacing);
  const double far = largestOf(q),
               most = double(kFarthest) * double(std::max({grid.dims.x, grid.dims.y, grid.dims.z}));
  if (far > most) q = q / far * most;
  return glm::vec3(q);
}

}  // namespace raymap::cpu
