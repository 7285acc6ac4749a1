#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace raymap {

/// Share of a cube that vertices keep to its sides: those of two cubes never coincide.
inline constexpr double kCubeMargin = 1e-3;

/// A symmetric matrix that tells how far an offset leads from a set of planes.
struct Quadric {
  float xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;

  float operator()(const glm::vec3& d) const {
    return d.x * d.x * xx + d.y * d.y * yy + d.z * d.z * zz +
           2.0f * (d.x * d.y * xy + d.y * d.z * yz + d.z * d.x * zx);
  }
};

/// Finds the point of a cube that lies closest to the planes of the surface in it: in a corner or on an edge
/// of the surface if there is one (Ju et al. 2002). Positions are in samples.
class PlaneFit {
 public:
  /// `low`: the cube's lowest corner.
  explicit PlaneFit(const glm::ivec3& low) : low_(low) {}

  /// A point where the surface crosses an edge of the cube: the vertex stays near them along the surface.
  void addCrossing(const glm::dvec3& point) {
    sum_ += point - low_;
    ++count_;
  }
  /// The tangent plane at a point of the surface. It counts the less the farther the point lies outside.
  void addPlane(const glm::dvec3& point, const glm::dvec3& normal, double weight = 1.0);

  /// Inside the cube, and never on its sides.
  glm::dvec3 solve() const;
  /// Of the crossings, as far inside.
  glm::dvec3 mean() const { return low_ + glm::clamp(sum_ / double(count_), kCubeMargin, 1.0 - kCubeMargin); }
  /// Of the planes alone, as their mean.
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
