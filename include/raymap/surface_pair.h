#pragma once

#include <raymap/field.h>

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

namespace raymap {

/// A point of each of two surfaces, and how far they are apart.
struct SurfacePair {
  double distance = std::numeric_limits<double>::infinity();  ///< Distance of the two points.
  /// Upper bound on the measured distance of the surfaces: `distance` itself of a least distance.
  double bound = std::numeric_limits<double>::infinity();
  glm::dvec3 point{std::numeric_limits<double>::quiet_NaN()};       ///< Point of the one surface.
  glm::dvec3 otherPoint{std::numeric_limits<double>::quiet_NaN()};  ///< Point of the other.
  uint32_t triangle = kNoTriangle;                                  ///< Triangle that holds `point`.
  uint32_t otherTriangle = kNoTriangle;                             ///< Triangle that holds `otherPoint`.
};

/// Pose of the other surface, and limit of the search for the least distance.
struct PairOptions {
  /// Pose of the other surface: it takes that one's coordinates to those of this one, as in `Scene`.
  glm::dmat4 pose{1.0};
  /// Surfaces as far or farther get this distance, no points and no triangles. Smaller is faster.
  double maxDistance = std::numeric_limits<double>::infinity();
};

/// Pose of the other surface, tolerance and direction of a Hausdorff distance.
struct HausdorffOptions {
  glm::dmat4 pose{1.0};  ///< As that of `PairOptions`.
  /// Most that `SurfacePair::bound` exceeds the distance; 0: 1e-4 of the diagonal of this surface's bounds.
  double tolerance = 0.0;
  /// Whether the farthest point may lie on either surface. Otherwise it is one of this surface.
  bool bothWays = true;
};

/// The point of some that is deepest inside a surface.
struct DeepestPoint {
  double depth = 0.0;               ///< Its distance from the surface; 0 if no point is inside.
  size_t point = 0;                 ///< Its number; the lowest if several are equally deep.
  glm::dvec3 closest{0.0};          ///< Closest point of the surface.
  uint32_t triangle = kNoTriangle;  ///< Triangle that holds it; `kNoTriangle` if no point is inside.
};

}  // namespace raymap
