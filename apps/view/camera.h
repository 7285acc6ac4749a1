#pragma once

#include <raymap/picture.h>

#include <glm/glm.hpp>

namespace raymap::view {

/// Size of a window in pixels.
struct WindowSize {
  int width = 1;
  int height = 1;
};

/// A camera that looks at a point and moves around it. It stays upright.
class Camera {
 public:
  /// Looks along the view's direction, from its eye, or else so that the box fills the window.
  Camera(const RenderOptions& view, const Box& box, const WindowSize& window);

  /// Moves around the point by a drag of so many pixels: the width of the window is half a turn.
  void orbit(const glm::dvec2& drag, const WindowSize& window);
  /// Moves the camera and the point so that what lies at its distance follows the cursor.
  void pan(const glm::dvec2& drag, const WindowSize& window);
  /// Moves closer to the point under the cursor by a factor; farther by one above 1.
  void zoom(double factor, const glm::dvec2& cursor, const WindowSize& window);
  /// Looks at a point, from the same side and distance.
  void lookAt(const glm::dvec3& point);
  /// Looks along a direction at the same point.
  void lookAlong(const glm::dvec3& direction);
  /// Moves back or forth until the box fills the window.
  void frame(const Box& box, const WindowSize& window);

  glm::dvec3 eye() const { return target_ - distance_ * forward_; }
  const glm::dvec3& target() const { return target_; }
  const glm::dvec3& forward() const { return forward_; }
  glm::dvec3 right() const;
  glm::dvec3 up() const { return glm::cross(right(), forward_); }
  /// Returns the unit direction of the ray through a point of the window, rows from the top.
  glm::dvec3 ray(const glm::dvec2& cursor, const WindowSize& window) const;
  /// Returns the point of the window at which a point is seen; `z` is its depth, positive in front.
  glm::dvec3 project(const glm::dvec3& point, const WindowSize& window) const;
  /// Sets the eye and the direction of a view.
  void place(RenderOptions& view) const;
  /// Returns the matrix from positions relative to the eye to clip coordinates of Vulkan.
  glm::mat4 matrix(const WindowSize& window, double nearest, double farthest) const;

 private:
  double pixelAngle(const WindowSize& window) const { return 2.0 * tangent_ / window.height; }

  glm::dvec3 up_;
  glm::dvec3 forward_;
  glm::dvec3 target_{0.0};
  double distance_ = 1.0;
  double tangent_;
};

}  // namespace raymap::view
