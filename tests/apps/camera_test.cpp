#include "view/camera.h"

#include <gtest/gtest.h>

#include <numbers>

namespace raymap::view {
namespace {

constexpr WindowSize kWindow{800, 600};
const Box kBox{{-1.0, -2.0, 0.0}, {3.0, 1.0, 4.0}};

Camera camera() {
  return {{.direction = {-0.6, -0.45, -1.0}}, kBox, kWindow};
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-9) {
  EXPECT_NEAR(glm::distance(a, b), 0.0, tolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(ViewCamera, FramesTheBox) {
  for (const WindowSize& window : {kWindow, WindowSize{300, 900}}) {
    const Camera framed({.direction = {0.2, -1.0, 0.3}}, kBox, window);
    expectNear(framed.target(), kBox.centre());
    double most = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p{corner & 1 ? kBox.max.x : kBox.min.x, corner & 2 ? kBox.max.y : kBox.min.y,
                         corner & 4 ? kBox.max.z : kBox.min.z};
      const glm::dvec3 seen = framed.project(p, window);
      const glm::dvec2 share = glm::abs(glm::dvec2(seen) / glm::dvec2(window.width, window.height) - 0.5);
      most = std::max({most, share.x, share.y});
      EXPECT_GT(seen.z, 0.0);
    }
    EXPECT_LT(most, 0.5);
    EXPECT_GT(most, 0.25);
  }
}

TEST(ViewCamera, StandsAtTheEyeOfAView) {
  RenderOptions view{.direction = {0.0, 0.0, -2.0}, .eye = glm::dvec3(1.0, -0.5, 9.0)};
  const Camera placed(view, kBox, kWindow);
  expectNear(placed.eye(), *view.eye);
  expectNear(placed.target(), {1.0, -0.5, 2.0});
  view.eye.reset();
  placed.place(view);
  expectNear(*view.eye, {1.0, -0.5, 9.0});
  expectNear(view.direction, {0.0, 0.0, -1.0});
}

TEST(ViewCamera, OrbitsAroundItsTarget) {
  Camera moved = camera();
  const double distance = glm::distance(moved.eye(), moved.target());
  const double right = glm::dot(moved.forward(), camera().right());
  moved.orbit({100.0, 0.0}, kWindow);
  expectNear(moved.target(), camera().target());
  EXPECT_NEAR(glm::distance(moved.eye(), moved.target()), distance, 1e-9);
  // Dragged to the right, the shape turns to the right: the camera goes to the left.
  EXPECT_GT(glm::dot(moved.forward(), camera().right()), right + 0.1);
  EXPECT_NEAR(moved.forward().y, camera().forward().y, 1e-9);
  moved.orbit({800.0 - 100.0, 0.0}, kWindow);  // Half a turn in all.
  expectNear({moved.forward().x, 0.0, moved.forward().z},
             {-camera().forward().x, 0.0, -camera().forward().z});
  // Down shows the top; it stops before the camera would stand on its head.
  Camera above = camera();
  above.orbit({0.0, 50.0}, kWindow);
  EXPECT_LT(above.forward().y, camera().forward().y);
  above.orbit({0.0, 5000.0}, kWindow);
  EXPECT_NEAR(std::asin(above.forward().y), -89.0 * std::numbers::pi / 180.0, 1e-9);
}

TEST(ViewCamera, PansWithTheCursorAndZoomsTowardsIt) {
  Camera moved = camera();
  const glm::dvec3 before = moved.project(kBox.centre(), kWindow);
  moved.pan({30.0, -20.0}, kWindow);
  const glm::dvec3 after = moved.project(kBox.centre(), kWindow);
  expectNear(after, before + glm::dvec3(30.0, -20.0, 0.0), 1e-6);

  Camera zoomed = camera();
  const glm::dvec2 cursor(200.0, 450.0);
  const double distance = glm::distance(zoomed.eye(), zoomed.target());
  const glm::dvec3 ray = zoomed.ray(cursor, kWindow);
  const glm::dvec3 under = zoomed.eye() + distance / glm::dot(ray, zoomed.forward()) * ray;
  zoomed.zoom(0.5, cursor, kWindow);
  const glm::dvec3 seen = zoomed.project(under, kWindow);
  EXPECT_NEAR(seen.x, cursor.x, 1e-6);
  EXPECT_NEAR(seen.y, cursor.y, 1e-6);
  EXPECT_NEAR(seen.z, 0.5 * distance, 1e-9);
}

TEST(ViewCamera, LooksAtPointsAndAlongAxes) {
  Camera moved = camera();
  moved.lookAt({5.0, 6.0, 7.0});
  const glm::dvec3 seen = moved.project({5.0, 6.0, 7.0}, kWindow);
  EXPECT_NEAR(seen.x, 400.0, 1e-9);
  EXPECT_NEAR(seen.y, 300.0, 1e-9);
  moved.lookAlong({-2.0, 0.0, 0.0});
  expectNear(moved.forward(), {-1.0, 0.0, 0.0});
  for (const double side : {-1.0, 1.0}) {
    moved.lookAlong({0.0, side, 0.0});
    EXPECT_GT(side * moved.forward().y, 0.999);
    EXPECT_NEAR(glm::length(moved.right()), 1.0, 1e-9);
  }
}

TEST(ViewCamera, MatrixShowsPointsWhereTheyAre) {
  const Camera seen = camera();
  const glm::mat4 matrix = seen.matrix(kWindow, 0.5, 40.0);
  for (const glm::dvec3& p : {kBox.min, kBox.max, kBox.centre()}) {
    const glm::vec4 clip = matrix * glm::vec4(glm::vec3(p - seen.eye()), 1.0F);
    const glm::dvec3 pixel = seen.project(p, kWindow);
    EXPECT_NEAR((clip.x / clip.w + 1.0F) * 400.0F, pixel.x, 1e-2);
    EXPECT_NEAR((clip.y / clip.w + 1.0F) * 300.0F, pixel.y, 1e-2);
    EXPECT_NEAR(clip.w, pixel.z, 1e-4);
    EXPECT_GT(clip.z, 0.0F);
    EXPECT_LT(clip.z, clip.w);
  }
  const glm::vec4 nearest = matrix * glm::vec4(glm::vec3(0.5 * seen.forward()), 1.0F);
  EXPECT_NEAR(nearest.z, 0.0F, 1e-5);
}

}  // namespace
}  // namespace raymap::view
