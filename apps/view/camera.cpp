#include "camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raymap::view {

namespace {

constexpr double kSteepest = 89.0 * std::numbers::pi / 180.0;
constexpr double kFilled = 0.86;  // Share of the window that a box fills.

glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return c * v + s * glm::cross(axis, v) + (1.0 - c) * glm::dot(axis, v) * axis;
}

}  // namespace

Camera::Camera(const RenderOptions& view, const Box& box, const WindowSize& window)
    : up_(glm::normalize(view.up)),
      forward_(glm::normalize(view.direction)),
      tangent_(std::tan(view.fieldOfView * std::numbers::pi / 360.0)) {
  frame(box, window);
  if (!view.eye) return;
  // The target is as far away as the middle of the box.
  distance_ = std::max(glm::dot(box.centre() - *view.eye, forward_), 1e-3 * distance_);
  target_ = *view.eye + distance_ * forward_;
}

glm::dvec3 Camera::right() const {
  return glm::normalize(glm::cross(forward_, up_));
}

void Camera::orbit(const glm::dvec2& drag, const WindowSize& window) {
  const double perPixel = std::numbers::pi / window.width;
  forward_ = turned(forward_, up_, -drag.x * perPixel);
  const double elevation = std::asin(std::clamp(glm::dot(forward_, up_), -1.0, 1.0));
  const double wanted = std::clamp(elevation - drag.y * perPixel, -kSteepest, kSteepest);
  forward_ = glm::normalize(turned(forward_, right(), wanted - elevation));
}

void Camera::pan(const glm::dvec2& drag, const WindowSize& window) {
  const double scale = distance_ * pixelAngle(window);
  target_ += scale * (drag.y * up() - drag.x * right());
}

void Camera::zoom(double factor, const glm::dvec2& cursor, const WindowSize& window) {
  const glm::dvec3 direction = ray(cursor, window);
  const glm::dvec3 under = eye() + distance_ / glm::dot(direction, forward_) * direction;
  target_ = under + factor * (target_ - under);
  distance_ *= factor;
}

void Camera::lookAt(const glm::dvec3& point) {
  target_ = point;
}

void Camera::lookAlong(const glm::dvec3& direction) {
  forward_ = glm::normalize(direction);
  // Straight along `up`, right and left would be lost.
  if (const double along = glm::dot(forward_, up_); std::abs(along) > std::sin(kSteepest)) {
    const glm::dvec3 side = std::abs(up_.z) > 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
    const glm::dvec3 level = glm::normalize(side - glm::dot(side, up_) * up_);
    forward_ = std::copysign(std::sin(kSteepest), along) * up_ + std::cos(kSteepest) * level;
  }
}

void Camera::frame(const Box& box, const WindowSize& window) {
  const glm::dvec3 size = box.size();
  const double narrow = std::min(1.0, double(window.width) / window.height);
  target_ = box.centre();
  distance_ = std::max(0.5 * glm::length(size), 1e-30) / std::sin(std::atan(kFilled * tangent_ * narrow));
}

glm::dvec3 Camera::ray(const glm::dvec2& cursor, const WindowSize& window) const {
  const glm::dvec2 off = pixelAngle(window) * (cursor - 0.5 * glm::dvec2(window.width, window.height));
  return glm::normalize(forward_ + off.x * right() - off.y * up());
}

glm::dvec3 Camera::project(const glm::dvec3& point, const WindowSize& window) const {
  const glm::dvec3 to = point - eye();
  const double depth = glm::dot(to, forward_), scale = 1.0 / (depth * pixelAngle(window));
  return {0.5 * window.width + scale * glm::dot(to, right()),
          0.5 * window.height - scale * glm::dot(to, up()), depth};
}

void Camera::place(RenderOptions& view) const {
  view.eye = eye();
  view.direction = forward_;
  view.up = up_;
}

glm::mat4 Camera::matrix(const WindowSize& window, double nearest, double farthest) const {
  const double aspect = double(window.width) / window.height;
  const glm::dvec3 x = right() / (tangent_ * aspect), y = -up() / tangent_;
  const double a = farthest / (farthest - nearest);
  const glm::dvec3 z = a * forward_;
  return {glm::vec4(x.x, y.x, z.x, forward_.x), glm::vec4(x.y, y.y, z.y, forward_.y),
          glm::vec4(x.z, y.z, z.z, forward_.z), glm::vec4(0.0, 0.0, -a * nearest, 0.0)};
}

}  // namespace raymap::view
