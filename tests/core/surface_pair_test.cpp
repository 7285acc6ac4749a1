#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "broken_meshes.h"
#include "error_code.h"
#include "random_pose.h"
#include "shapes.h"

namespace raymap {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

std::vector<Triangle> trianglesOf(const Mesh& mesh, const glm::dmat4& pose = glm::dmat4(1.0)) {
  std::vector<Triangle> triangles;
  for (const glm::uvec3& t : mesh.triangles) {
    Triangle& corners = triangles.emplace_back();
    for (int c = 0; c < 3; ++c) corners[size_t(c)] = glm::dvec3(pose * glm::dvec4(mesh.position(t[c]), 1.0));
  }
  return triangles;
}

glm::dvec3 onSegment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const double length2 = glm::dot(b - a, b - a);
  return a + (length2 > 0.0 ? std::clamp(glm::dot(p - a, b - a) / length2, 0.0, 1.0) : 0.0) * (b - a);
}

/// Returns the distance of a point to a triangle, by its sides and its plane.
double distanceTo(const glm::dvec3& p, const Triangle& t) {
  double least = INFINITY;
  for (size_t i = 0; i < 3; ++i)
    least = std::min(least, glm::distance(p, onSegment(p, t[i], t[(i + 1) % 3])));
  const glm::dvec3 normal = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
  bool isOver = true;
  for (size_t i = 0; i < 3; ++i)
    isOver = isOver && glm::dot(glm::cross(t[(i + 1) % 3] - t[i], p - t[i]), normal) > 0.0;
  return isOver ? std::abs(glm::dot(p - t[0], normal)) : least;
}

/// Returns the distance of a segment to a triangle by golden section: it is a convex function along the
/// segment.
double segmentDistance(const glm::dvec3& a, const glm::dvec3& b, const Triangle& t) {
  double low = 0.0, high = 1.0, least = INFINITY;
  const auto at = [&](double s) {
    const double d = distanceTo(a + s * (b - a), t);
    least = std::min(least, d);
    return d;
  };
  for (int step = 0; step < 50; ++step) {
    const double s = low + 0.382 * (high - low), u = low + 0.618 * (high - low);
    (at(s) < at(u) ? high : low) = at(s) < at(u) ? u : s;
  }
  return least;
}

/// Two triangles are closest at a side of one of them.
double bruteForce(const std::vector<Triangle>& a, const std::vector<Triangle>& b) {
  double least = INFINITY;
  for (const Triangle& s : a)
    for (const Triangle& t : b)
      for (size_t i = 0; i < 3; ++i) {
        least = std::min(least, segmentDistance(s[i], s[(i + 1) % 3], t));
        least = std::min(least, segmentDistance(t[i], t[(i + 1) % 3], s));
      }
  return least;
}

glm::dmat4 shifted(double x, double y = 0.0, double z = 0.0) {
  return glm::translate(glm::dmat4(1.0), glm::dvec3(x, y, z));
}

/// Expects that the points lie on the triangles that are named, and as far apart as said.
void expectHolds(const SurfacePair& found, const Mesh& a, const Mesh& b, const glm::dmat4& pose) {
  ASSERT_LT(found.triangle, a.triangles.size());
  ASSERT_LT(found.otherTriangle, b.triangles.size());
  EXPECT_NEAR(glm::distance(found.point, found.otherPoint), found.distance, 1e-12);
  EXPECT_LT(distanceTo(found.point, trianglesOf(a)[found.triangle]), 1e-12);
  EXPECT_LT(distanceTo(found.otherPoint, trianglesOf(b, pose)[found.otherTriangle]), 1e-12);
}

TEST(SurfacePair, IsAsBruteForceSays) {
  std::mt19937 random(1);
  const std::vector<Mesh> meshes{shapes::soup(12, 1), shapes::box({-1, -2, -0.5}, {1, 2, 0.5}),
                                 shapes::torus(1.0, 0.3, 6, 4), shapes::sphere(0.7, 0)};
  int crossing = 0, apart = 0;
  for (int round = 0; round < 32; ++round) {
    SCOPED_TRACE(round);
    const Mesh &a = meshes[size_t(round) % 4], &b = meshes[size_t(round / 4) % 4];
    const glm::dmat4 pose = randomPose(random, 1.5);
    const SurfacePair found = Surface(a).distanceTo(Surface(b), {.pose = pose});
    const double truth = bruteForce(trianglesOf(a), trianglesOf(b, pose));
    EXPECT_NEAR(found.distance, truth, 1e-9);
    EXPECT_LE(found.distance, truth + 1e-13);
    EXPECT_EQ(found.bound, found.distance);
    expectHolds(found, a, b, pose);
    ++(found.distance == 0.0 ? crossing : apart);
    const SurfacePair back = Surface(b).distanceTo(Surface(a), {.pose = glm::inverse(pose)});
    EXPECT_NEAR(back.distance, found.distance, 1e-13);
  }
  EXPECT_GT(crossing, 5);
  EXPECT_GT(apart, 5);
}

TEST(SurfacePair, OfFineMeshesIsThatOfTheirShapes) {
  const Surface ball(shapes::sphere(1.0, 5)), other(shapes::sphere(0.5, 5));
  std::mt19937 random(2);
  for (int round = 0; round < 20; ++round) {
    const glm::dmat4 pose = randomPose(random, 5.0);
    const double between = glm::length(glm::dvec3(pose[3]));
    const double truth = between > 1.5 ? between - 1.5 : between < 0.5 ? 0.5 - between : 0.0;
    EXPECT_NEAR(ball.distanceTo(other, {.pose = pose}).distance, truth, 2e-3);
  }
  const Surface cube(shapes::box({-1, -1, -1}, {1, 1, 1}));
  EXPECT_EQ(cube.distanceTo(cube, {.pose = shifted(2.25)}).distance, 0.25);
  EXPECT_EQ(cube.distanceTo(cube, {.pose = shifted(3.0, 4.0)}).distance, std::sqrt(5.0));
  EXPECT_EQ(cube.distanceTo(cube, {.pose = shifted(2.0)}).distance, 0.0);
  EXPECT_EQ(cube.distanceTo(cube).distance, 0.0);
}

TEST(SurfacePair, IsTheSameFarFromTheOrigin) {
  Mesh far = shapes::sphere(1.0, 3), near = far;
  far.origin = {5e6, -3e6, 2e6};
  const SurfacePair found = Surface(far).distanceTo(Surface(near), {.pose = shifted(5e6 + 3.0, -3e6, 2e6)});
  EXPECT_NEAR(found.distance, Surface(near).distanceTo(Surface(near), {.pose = shifted(3.0)}).distance, 1e-8);
  EXPECT_NEAR(found.point.x, 5e6 + 1.0, 1e-3);
}

TEST(SurfacePair, EndsAtTheLargestDistance) {
  const Surface cube(shapes::box({-1, -1, -1}, {1, 1, 1}));
  const SurfacePair near = cube.distanceTo(cube, {.pose = shifted(2.25), .maxDistance = 0.26}),
                    far = cube.distanceTo(cube, {.pose = shifted(2.25), .maxDistance = 0.25});
  EXPECT_EQ(near.distance, 0.25);
  EXPECT_EQ(far.distance, 0.25);
  EXPECT_EQ(far.triangle, kNoTriangle);
  EXPECT_TRUE(std::isnan(far.point.x));
  EXPECT_EQ(codeOf([&] { cube.distanceTo(cube, {.maxDistance = 0.0}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { cube.distanceTo(cube, {.pose = glm::dmat4(0.0)}); }), ErrorCode::Usage);
}

/// Returns the largest distance of points that lie densely on some triangles from others.
double sampledHausdorff(const std::vector<Triangle>& from, const std::vector<Triangle>& to) {
  constexpr int kSteps = 24;
  double most = 0.0;
  for (const auto& [a, b, c] : from)
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) {
        const glm::dvec3 p = a + double(i) / kSteps * (b - a) + double(j) / kSteps * (c - a);
        double least = INFINITY;
        for (const Triangle& t : to) least = std::min(least, distanceTo(p, t));
        most = std::max(most, least);
      }
  return most;
}

TEST(Hausdorff, LiesBetweenWhatSamplesShowAndItsBound) {
  std::mt19937 random(3);
  const std::vector<Mesh> meshes{shapes::soup(6, 1), shapes::box({-1, -2, -0.5}, {1, 2, 0.5}),
                                 shapes::torus(1.0, 0.3, 6, 4)};
  for (int round = 0; round < 9; ++round) {
    SCOPED_TRACE(round);
    const Mesh &a = meshes[size_t(round) % 3], &b = meshes[size_t(round / 3) % 3];
    const glm::dmat4 pose = randomPose(random, 0.5);
    const HausdorffOptions oneWay{.pose = pose, .tolerance = 1e-3, .bothWays = false};
    const SurfacePair there = Surface(a).hausdorff(Surface(b), oneWay);
    const double shown = sampledHausdorff(trianglesOf(a), trianglesOf(b, pose));
    EXPECT_GE(there.distance, shown - 1e-3);
    EXPECT_GE(there.bound, shown - 1e-12);
    EXPECT_GE(there.bound, there.distance);
    EXPECT_LE(there.bound, there.distance + 1e-3);
    expectHolds(there, a, b, pose);
    const SurfacePair back = Surface(b).hausdorff(
                          Surface(a), {.pose = glm::inverse(pose), .tolerance = 1e-3, .bothWays = false}),
                      both = Surface(a).hausdorff(Surface(b), {.pose = pose, .tolerance = 1e-3});
    EXPECT_NEAR(both.distance, std::max(there.distance, back.distance), 1e-3);
    EXPECT_LE(both.bound, both.distance + 1e-3);
    expectHolds(both, a, b, pose);
  }
}

TEST(Hausdorff, OfShapesIsWhatGeometrySays) {
  const Surface cube(shapes::box({-1, -1, -1}, {1, 1, 1})),
      small(shapes::box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}));
  const SurfacePair outer = cube.hausdorff(small, {.bothWays = false});
  EXPECT_NEAR(outer.distance, std::sqrt(0.75), 1e-12);  // From a corner to a corner.
  EXPECT_NEAR(glm::length(outer.point), std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(small.hausdorff(cube, {.bothWays = false}).distance, 0.5, 1e-12);
  EXPECT_NEAR(small.hausdorff(cube).distance, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(glm::length(small.hausdorff(cube).otherPoint), std::sqrt(3.0), 1e-12);
  const SurfacePair same = cube.hausdorff(cube);
  EXPECT_LT(same.distance, 1e-15);
  EXPECT_LE(same.bound, 1e-4 * std::sqrt(12.0));
  // The middle of a side is farthest, where no face has a corner.
  const Surface bar(shapes::box({-2, -0.01, -0.01}, {2, 0.01, 0.01})),
      ends(shapes::joined(shapes::box({-2.1, -0.1, -0.1}, {-1.9, 0.1, 0.1}),
                          shapes::box({1.9, -0.1, -0.1}, {2.1, 0.1, 0.1})));
  const SurfacePair middle = bar.hausdorff(ends, {.tolerance = 1e-4, .bothWays = false});
  EXPECT_NEAR(middle.distance, 1.9, 2e-4);
  EXPECT_NEAR(middle.point.x, 0.0, 1e-3);
  const Surface ball(shapes::sphere(1.0, 4)), larger(shapes::sphere(1.2, 4));
  EXPECT_NEAR(ball.hausdorff(larger).distance, 0.2, 5e-3);
  EXPECT_EQ(codeOf([&] { ball.hausdorff(larger, {.tolerance = -1.0}); }), ErrorCode::Usage);
}

TEST(Hausdorff, IsTheSameForAnyNumberOfThreads) {
  const Surface a(shapes::torus(1.0, 0.3, 40, 20)), b(withHoles(shapes::torus(1.0, 0.31, 50, 22), 3, 0.1, 1));
  const HausdorffOptions options{.pose = shifted(0.05), .tolerance = 1e-4};
  const SurfacePair one = a.hausdorff(b, options, {.threads = 1});
  for (const int threads : {2, 5}) {
    const SurfacePair more = a.hausdorff(b, options, {.threads = threads});
    EXPECT_EQ(std::memcmp(&one, &more, sizeof one), 0);
  }
}

TEST(Surface, FindsTheDeepestPoint) {
  const Surface ball(shapes::sphere(1.0, 4));
  const std::vector<glm::dvec3> points{{2, 0, 0}, {0.5, 0, 0}, {0, 0.25, 0}, {NAN, 0, 0}, {0, 0, 0.9}};
  const DeepestPoint found = ball.deepest(points);
  EXPECT_EQ(found.point, 2u);
  EXPECT_NEAR(found.depth, 0.75, 5e-3);
  EXPECT_NEAR(glm::distance(found.closest, points[2]), found.depth, 1e-12);
  EXPECT_LT(found.triangle, ball.mesh().triangleCount);
  const DeepestPoint none = ball.deepest(std::span(points).first(1));
  EXPECT_EQ(none.depth, 0.0);
  EXPECT_EQ(none.triangle, kNoTriangle);
  const Surface unsignedBall(shapes::sphere(1.0, 2), {.sign = SignMode::None});
  EXPECT_EQ(codeOf([&] { unsignedBall.deepest(points); }), ErrorCode::Usage);
}

TEST(Scene, MeasuresBetweenBodies) {
  std::mt19937 random(4);
  const std::vector<Mesh> meshes{shapes::soup(12, 1), shapes::box({-1, -2, -0.5}, {1, 2, 0.5}),
                                 shapes::torus(1.0, 0.3, 8, 5)};
  Scene scene;
  for (size_t b = 0; b < meshes.size(); ++b)
    scene.add(std::to_string(b), std::make_shared<const Surface>(meshes[b]));
  std::vector<glm::dmat4> poses;
  for (int i = 0; i < 12; ++i) poses.push_back(randomPose(random, 4.0));
  const std::vector<glm::uvec2> pairs{{0, 1}, {2, 0}, {1, 2}};
  const auto found = scene.distancesBetween(pairs, {.poses = poses, .count = 4});
  ASSERT_EQ(found.size(), 12u);
  for (size_t i = 0; i < found.size(); ++i) {
    const size_t c = i / 3, a = pairs[i % 3].x, b = pairs[i % 3].y;
    const auto triangles = trianglesOf(meshes[a], poses[3 * c + a]),
               others = trianglesOf(meshes[b], poses[3 * c + b]);
    EXPECT_NEAR(found[i].distance, bruteForce(triangles, others), 1e-9);
    EXPECT_LT(distanceTo(found[i].point, triangles[found[i].triangle]), 1e-12);
    EXPECT_LT(distanceTo(found[i].otherPoint, others[found[i].otherTriangle]), 1e-12);
  }
  scene.setPoses(std::span(poses).subspan(3, 3));
  const auto own = scene.distancesBetween(pairs);
  for (const int threads : {1, 3}) {
    const auto again =
        scene.distancesBetween(pairs, {.poses = poses, .count = 4}, INFINITY, {.threads = threads});
    EXPECT_EQ(std::memcmp(again.data(), found.data(), sizeof(SurfacePair) * found.size()), 0);
  }
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(own[i].distance, found[3 + i].distance);
  EXPECT_EQ(codeOf([&] { scene.distancesBetween(std::vector<glm::uvec2>{{0, 3}}); }), ErrorCode::Usage);
  Field field = generate(meshes[1], fitGrid(meshes[1], {.resolution = 8}), {}, {.device = "cpu"}).field;
  scene.add("field", std::make_shared<const Field>(std::move(field)));
  EXPECT_EQ(codeOf([&] { scene.distancesBetween(std::vector<glm::uvec2>{{0, 3}}); }), ErrorCode::Usage);
}

}  // namespace
}  // namespace raymap
