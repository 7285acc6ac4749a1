#include "picture/camera.h"

#include <raymap/error.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "base/text.h"

namespace raymap {

namespace {

// Share of the picture's width or height that the shape fills. The rest is for its shadow.
constexpr double kFilled = 0.86;

/// Returns a direction that is not parallel to `forward`, `up` if possible.
glm::dvec3 sideReference(const glm::dvec3& up, const glm::dvec3& forward) {
  for (const glm::dvec3& v : {up, glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0)})
    if (glm::length(glm::cross(forward, v)) > 1e-6) return v;
  return {1, 0, 0};
}

}  // namespace

glm::dvec3 unitVector(const glm::dvec3& v, const char* name) {
  const double length = glm::length(v);
  if (!(length > 0.0) || !std::isfinite(length))
    throw Error(ErrorCode::Usage, std::string("the ") + name + " (" + numberText(v.x) + ", " +
                                      numberText(v.y) + ", " + numberText(v.z) +
                                      ") has no length; give a vector that points somewhere");
  return v / length;
}

Camera::Camera(const RenderOptions& options, const Reach& reach)
    : forward_(unitVector(options.direction, "view direction")),
      tangent_(std::tan(options.fieldOfView * std::numbers::pi / 360.0)),
      width_(options.width),
      height_(options.height) {
  if (!(options.fieldOfView >= 1.0 && options.fieldOfView <= 150.0))
    throw Error(ErrorCode::Usage,
                "the field of view must be 1 to 150 degrees, not " + numberText(options.fieldOfView));
  const glm::dvec3 up = unitVector(options.up, "up vector");
  right_ = glm::normalize(glm::cross(forward_, sideReference(up, forward_)));
  up_ = glm::cross(right_, forward_);
  frame(reach, up);
}

Camera::Camera(const RenderOptions& options, const Shape& shape)
    : Camera(options, [&](std::span<const glm::dvec3> directions) { return shape.reach(directions); }) {
  if (!options.eye) return;
  const Grid& grid = shape.field().grid();
  eye_ = (*options.eye - grid.origin) / grid.spacing;
  if (!std::isfinite(eye_.x + eye_.y + eye_.z))
    throw Error(ErrorCode::Usage, "the place of the camera must be finite");
}

/// Places the eye so that the view's side planes, tilted inward a little, enclose and touch the shape. A
/// plane's normal is n = c*side - s*forward, and the shape reaches r along n. The plane touches the shape if
/// dot(n, e) = r for the eye e. Two opposite sides give the eye's position across and its distance; the
/// larger of both distances is used.
void Camera::frame(const Reach& reachOf, const glm::dvec3& floorNormal) {
  const double tall = std::atan(kFilled * tangent_);
  const double wide = std::atan(kFilled * tangent_ * width_ / height_);
  const auto plane = [&](const glm::dvec3& side, double angle) {
    return std::cos(angle) * side - std::sin(angle) * forward_;
  };
  const glm::dvec3 directions[] = {plane(up_, tall), plane(-up_, tall), plane(right_, wide),
                                   plane(-right_, wide), -floorNormal};
  const std::vector<double> reach = reachOf(directions);
  const double back = std::max((reach[0] + reach[1]) / (2.0 * std::sin(tall)),
                               (reach[2] + reach[3]) / (2.0 * std::sin(wide)));
  const double high = (reach[0] - reach[1]) / (2.0 * std::cos(tall));
  const double across = (reach[2] - reach[3]) / (2.0 * std::cos(wide));
  eye_ = high * up_ + across * right_ - back * forward_;
  floor_ = -reach[4];
}

Ray Camera::ray(double x, double y) const {
  const double scale = 2.0 * tangent_ / height_;
  const glm::dvec3 direction =
      forward_ + scale * (x - 0.5 * width_) * right_ - scale * (y - 0.5 * height_) * up_;
  return {eye_, glm::normalize(direction)};
}

}  // namespace raymap
