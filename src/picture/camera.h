#pragma once

#include <raymap/picture.h>

#include <functional>
#include <span>
#include <vector>

#include "picture/shape.h"

namespace raymap {

struct Ray {
  glm::dvec3 origin;
  glm::dvec3 direction;  // Unit vector.
};

/// A pinhole camera that frames what it shows, a shape in sample coordinates or anything else.
class Camera {
 public:
  /// Function that returns how far the shown object reaches along each unit direction.
  using Reach = std::function<std::vector<double>(std::span<const glm::dvec3> directions)>;

  /// Throws `Error(Usage)` if a direction has no length or the field of view is not 1 to 150 degrees.
  Camera(const RenderOptions& options, const Reach& reach);
  /// Stands at `options.eye` if there is one. Throws `Error(Usage)` also if that is not finite.
  Camera(const RenderOptions& options, const Shape& shape);

  /// Returns the ray through a point of the picture. Pixel (0,0) covers 0 to 1; rows count from the top.
  Ray ray(double x, double y) const;
  /// Returns the height of the floor under the shape, along `RenderOptions::up`.
  double floor() const { return floor_; }
  /// Returns the height of the picture, in pixels.
  double height() const { return height_; }
  /// Returns the width of a pixel at distance 1.
  double pixelAngle() const { return 2.0 * tangent_ / height_; }

  const glm::dvec3& eye() const { return eye_; }
  const glm::dvec3& right() const { return right_; }
  const glm::dvec3& up() const { return up_; }
  const glm::dvec3& forward() const { return forward_; }

 private:
  void frame(const Reach& reach, const glm::dvec3& floorNormal);

  glm::dvec3 eye_{0.0}, right_, up_, forward_;
  double tangent_;
  double floor_ = 0.0;
  double width_, height_;
};

/// Returns `v` at length 1. Throws `Error(Usage)`, which calls it `name`, if it has no length.
glm::dvec3 unitVector(const glm::dvec3& v, const char* name);

}  // namespace raymap
