#pragma once

#include <glm/glm.hpp>

namespace raymap {

/// Sum of the squared distances to planes, weighted by areas (Garland & Heckbert 1997).
struct PlaneQuadric {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0, x = 0.0, y = 0.0, z = 0.0, one = 0.0;

  void addPlane(const glm::dvec3& normal, const glm::dvec3& point, double weight);
  void add(const PlaneQuadric& other);
  /// Returns the mean square of a point's distances to the planes.
  double meanSquare(const glm::dvec3& p) const;
};

}  // namespace raymap
