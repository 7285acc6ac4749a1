#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace raymap {

/// Distance that vertices keep from the sides of their cube, in samples. Vertices of two cubes therefore
/// never coincide.
inline constexpr double kCubeMargin = 1e-3;

/// Symmetric matrix of a quadratic form: the mean squared distance of an offset from a set of planes.
struct Quadric {
  float xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;

  float operator()(const glm::vec3& d) const {
    return d.x * d.x * xx + d.y * d.y * yy + d.z * d.z * zz +
           2.0f * (d.x * d.y * xy + d.y * d.z * yz + d.z * d.x * zx);
  }
};

/// Finds the point of a cube closest to the planes of the surface in the cube (Ju et al. 2002). If the
/// surface has a corner or an edge there, the point lies on it. Positions are in samples.
class PlaneFit {
 public:
  /// `low` is the cube's lowest corner.
  explicit PlaneFit(const glm::ivec3& low) : low_(low) {}

  /// Adds a point where the surface crosses an edge of the cube. The vertex stays near these points along the
  /// surface.
  void addCrossing(const glm::dvec3& point) {
    sum_ += point - low_;
    ++count_;
  }
  /// Adds the tangent plane at a point of the surface. Its weight falls with the point's distance outside the
  /// cube.
  void addPlane(const glm::dvec3& point, const glm::dvec3& normal, double weight = 1.0);

  /// Returns the vertex's position, inside the cube and never on its sides.
  glm::dvec3 solve() const;
  /// Returns the mean of the crossings, kept off the cube's sides likewise.
  glm::dvec3 mean() const { return low_ + glm::clamp(sum_ / double(count_), kCubeMargin, 1.0 - kCubeMargin); }
  /// Returns the mean quadric of the planes, without the crossings.
  Quadric quadric() const;

 private:
  struct Plane {
    glm::dvec3 point, normal;
    double weight;
  };

  glm::dvec3 closest() const;
  glm::dvec3 offset(const glm::dvec3& p) const;

  glm::dvec3 low_;
  std::vector<Plane> planes_;
  glm::dmat3 matrix_{0.0};
  glm::dvec3 right_{0.0};
  double weight_ = 0.0;
  glm::dvec3 sum_{0.0};
  int count_ = 0;
};

}  // namespace raymap
