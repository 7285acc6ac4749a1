#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

namespace raymap {

inline double squareOf(const glm::dvec3& v) {
  return glm::dot(v, v);
}

/// A triangle with an area, to measure distances from.
class FaceShape {
 public:
  FaceShape() = default;  // Left unset: each try has 24 and uses about six.
  FaceShape(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& normal)
      : corners_{a, b, c}, normal_(normal) {
    for (size_t k = 0; k < 3; ++k) {
      edges_[k] = corners_[(k + 1) % 3] - corners_[k];
      inwards_[k] = glm::cross(normal_, edges_[k]);
    }
  }

  /// Returns whether a point lies straight above or below the face, within a squared distance.
  bool isBeside(const glm::dvec3& p, double limit) const {
    return squaredHeight(p) <= limit && glm::dot(inwards_[0], p - corners_[0]) >= 0.0 &&
           glm::dot(inwards_[1], p - corners_[1]) >= 0.0 && glm::dot(inwards_[2], p - corners_[2]) >= 0.0;
  }

  double squaredHeight(const glm::dvec3& p) const {
    const double height = glm::dot(normal_, p - corners_[0]);
    return height * height;
  }

  double squaredDistance(const glm::dvec3& p) const {
    if (isBeside(p, INFINITY)) return squaredHeight(p);
    double least = INFINITY;
    for (size_t k = 0; k < 3; ++k) {
      const glm::dvec3 d = p - corners_[k];
      const double along = std::clamp(glm::dot(edges_[k], d) / squareOf(edges_[k]), 0.0, 1.0);
      least = std::min(least, squareOf(d - along * edges_[k]));
    }
    return least;
  }

 private:
  std::array<glm::dvec3, 3> corners_, edges_, inwards_;
  glm::dvec3 normal_;
};

}  // namespace raymap
