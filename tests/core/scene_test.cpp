#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "any_threads.h"
#include "broken_meshes.h"
#include "contains.h"
#include "error_code.h"
#include "method/pose.h"
#include "random_pose.h"
#include "shapes.h"

namespace raymap {
namespace {

const SceneOptions kUnion{.body = true, .closest = true, .gradient = true};
const SceneOptions kEachBody{.body = true, .closest = true, .gradient = true, .distances = true};

std::shared_ptr<const Surface> prepared(const Mesh& mesh, const SurfaceOptions& options = {}) {
  return std::make_shared<const Surface>(mesh, options);
}

std::vector<glm::dmat4> randomPoses(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<glm::dmat4> poses(count);
  for (glm::dmat4& pose : poses) pose = randomPose(random, 2.0);
  return poses;
}

std::vector<glm::dvec3> worldPoints(size_t count, double reach, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-reach, reach);
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points)
    for (int a = 0; a < 3; ++a) p[a] = unit(random);
  return points;
}

/// Closed, broken, open and unsigned surfaces. A point that the low threshold of the bowl lets count as
/// inside may lie beyond its bounds.
std::vector<std::shared_ptr<const Surface>> makeVarious() {
  const Mesh sphere = shapes::sphere(0.8, 2);
  const Mesh bowl = keepTriangles(sphere, [&](const glm::uvec3& t) {
    return sphere.position(t.x).z < 0.3 && sphere.position(t.y).z < 0.3 && sphere.position(t.z).z < 0.3;
  });
  return {prepared(shapes::box({-0.5, -0.3, -1}, {0.5, 0.3, 1})),
          prepared(withHoles(shapes::torus(1.0, 0.3, 24, 12), 3, 0.1, 1)),
          prepared(bowl, {.threshold = 0.15}),
          prepared(shapes::sphere(0.6, 2, {3, 0, 0}), {.sign = SignMode::None}),
          prepared(withFlippedFaces(shapes::sphere(0.7, 2), 0.3, 3)),
          prepared(shapes::soup(20, 4))};
}

const std::vector<std::shared_ptr<const Surface>>& variousSurfaces() {
  static const std::vector<std::shared_ptr<const Surface>> kSurfaces = makeVarious();
  return kSurfaces;
}

Scene variousScene(unsigned seed) {
  Scene scene;
  const std::vector<std::shared_ptr<const Surface>>& surfaces = variousSurfaces();
  const std::vector<glm::dmat4> poses = randomPoses(surfaces.size(), seed);
  for (size_t b = 0; b < surfaces.size(); ++b) scene.add("body " + std::to_string(b), surfaces[b], poses[b]);
  return scene;
}

Field sceneField(const Mesh& mesh, int resolution = 24) {
  return generate(mesh, fitGrid(mesh, {.resolution = resolution}), {}, {.device = "cpu"}).field;
}

TEST(Scene, BodiesAreAsBruteForceSays) {
  const std::vector<std::shared_ptr<const Surface>>& surfaces = variousSurfaces();
  const std::vector<glm::dmat4> poses = randomPoses(surfaces.size(), 5);
  Scene scene;
  for (size_t b = 0; b < surfaces.size(); ++b) scene.add(std::to_string(b), surfaces[b], poses[b]);
  const std::vector<glm::dvec3> points = worldPoints(2000, 4.0, 6);
  const SceneResult found = scene.query(points, kEachBody);
  std::vector<double> least(points.size(), double(INFINITY));
  for (size_t b = 0; b < surfaces.size(); ++b) {
    const glm::dmat4 back = glm::inverse(poses[b]);
    std::vector<glm::dvec3> inBody;
    for (const glm::dvec3& p : points) inBody.emplace_back(back * glm::dvec4(p, 1.0));
    const QueryResult alone = surfaces[b]->query(inBody, {.closest = true, .direction = true});
    for (size_t i = 0; i < points.size(); ++i) {
      SCOPED_TRACE(testing::Message() << "body " << b << ", point " << i);
      ASSERT_NEAR(found.distances[i * surfaces.size() + b], alone.distance[i], 1e-12);
      least[i] = std::min(least[i], alone.distance[i]);
      if (found.body[i] != b) continue;
      const glm::dvec3 closest(poses[b] * glm::dvec4(alone.closest[i], 1.0)),
          towards(poses[b] * glm::dvec4(alone.direction[i], 0.0));
      ASSERT_LT(glm::distance(found.closest[i], closest), 1e-12);
      ASSERT_LT(glm::distance(found.gradient[i], alone.distance[i] < 0.0 ? towards : -towards), 1e-9);
    }
  }
  for (size_t i = 0; i < points.size(); ++i) ASSERT_NEAR(found.distance[i], least[i], 1e-12);
}

/// Expects the same answers whether or not bodies are left out.
void expectSameIfAllAreAsked(const Scene& scene, unsigned seed) {
  for (const double reach : {1.0, 4.0, 1000.0}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", points within " << reach);
    const std::vector<glm::dvec3> points = worldPoints(1500, reach, seed);
    const SceneResult some = scene.query(points, kUnion), all = scene.query(points, kEachBody);
    EXPECT_TRUE(sameBits(some.distance, all.distance));
    EXPECT_TRUE(sameBits(some.body, all.body));
    EXPECT_TRUE(sameBits(some.closest, all.closest));
    EXPECT_TRUE(sameBits(some.gradient, all.gradient));
  }
}

TEST(Scene, LeavingBodiesOutChangesNoBit) {
  for (unsigned seed = 0; seed < 3; ++seed) expectSameIfAllAreAsked(variousScene(seed), seed);
}

TEST(Scene, LeavingFieldsOutChangesNoBit) {
  const Mesh ball = shapes::sphere(0.8, 2), box = shapes::box({-0.5, -0.3, -1}, {0.5, 0.3, 1});
  Field unbounded = sceneField(ball);
  unbounded.surfaceBounds = {};
  Field clamped = sceneField(box);
  clamped.clampDistance = 0.1;
  for (float& d : clamped.distance) d = std::clamp(d, -0.1f, 0.1f);
  const Grid part = fitGrid(ball, {.resolution = 12, .box = Box{{-0.5, -0.5, -0.5}, {0.5, 0.5, 2}}});
  const std::vector<std::shared_ptr<const Field>> fields{
      std::make_shared<const Field>(sceneField(ball)), std::make_shared<const Field>(std::move(unbounded)),
      std::make_shared<const Field>(std::move(clamped)),
      std::make_shared<const Field>(generate(ball, part, {}, {.device = "cpu"}).field)};
  for (unsigned seed = 0; seed < 3; ++seed) {
    const std::vector<glm::dmat4> poses = randomPoses(fields.size() + 2, seed);
    Scene scene;
    for (size_t b = 0; b < fields.size(); ++b) scene.add(std::to_string(b), fields[b], poses[b]);
    scene.add("sparse", std::make_shared<const Field>(toSparse(*fields[0])), poses[fields.size()]);
    scene.add("surface", prepared(box), poses[fields.size() + 1]);
    expectSameIfAllAreAsked(scene, seed);
  }
}

constexpr size_t kMany = 60;

/// Surfaces and fields in turn, of which every fourth is twice at the same place. A field without the bounds
/// of its surface is near everywhere.
Scene manyBodies(bool areAllBounded, std::span<const glm::dmat4> poses) {
  const std::vector<std::shared_ptr<const Surface>>& surfaces = variousSurfaces();
  const auto field = std::make_shared<const Field>(sceneField(shapes::sphere(0.8, 2)));
  Field unbounded = sceneField(shapes::sphere(0.5, 1));
  unbounded.surfaceBounds = {};
  Scene scene;
  for (size_t b = 0; b < kMany; ++b) {
    const size_t place = b % 4 == 3 ? b - 1 : b;
    if (place % 5 == 0)
      scene.add(std::to_string(b), field, poses[place]);
    else
      scene.add(std::to_string(b), surfaces[place % surfaces.size()], poses[place]);
  }
  if (!areAllBounded)
    scene.add("unbounded", std::make_shared<const Field>(std::move(unbounded)), poses[kMany]);
  return scene;
}

/// Poses about many places.
std::vector<glm::dmat4> spreadPoses(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<glm::dmat4> poses(count);
  for (glm::dmat4& pose : poses) pose = randomPose(random, 6.0);
  return poses;
}

/// Points among the bodies, far from them, at the same place and nowhere.
std::vector<glm::dvec3> manyPoints(size_t count, unsigned seed) {
  std::vector<glm::dvec3> points = worldPoints(count, 8.0, seed);
  for (size_t i = 0; i < count; i += 10) points[i] *= 50.0;
  for (size_t i = 1; i < count; i += 10) points[i] = points[1];
  points[2].y = double(NAN);
  points[3].x = double(INFINITY);
  return points;
}

void expectSame(const SceneResult& a, const SceneResult& b) {
  EXPECT_TRUE(sameBits(a.distance, b.distance));
  EXPECT_TRUE(sameBits(a.body, b.body));
  EXPECT_TRUE(sameBits(a.closest, b.closest));
  EXPECT_TRUE(sameBits(a.gradient, b.gradient));
  EXPECT_TRUE(sameBits(a.triangle, b.triangle));
}

TEST(Scene, ManyBodiesAreAsIfAllWereAsked) {
  constexpr size_t kCount = 3, kPoints = 700;
  const std::vector<uint32_t> left{2, 17, 40};
  const std::vector<glm::dvec3> points = manyPoints(kCount * kPoints, 2);
  for (const bool areAllBounded : {true, false}) {
    const std::vector<glm::dmat4> poses = spreadPoses((kMany + 1) * kCount, 1);
    const Scene scene = manyBodies(areAllBounded, poses);
    for (const bool hasOwnPoints : {false, true})
      for (const double most : {double(INFINITY), 3.0, 0.2}) {
        SCOPED_TRACE(testing::Message() << areAllBounded << hasOwnPoints << ", distances up to " << most);
        const Configurations configurations{std::span(poses).first(scene.size() * kCount), kCount,
                                            hasOwnPoints};
        const auto given = std::span(points).first(hasOwnPoints ? points.size() : kPoints);
        SceneOptions options = kUnion;
        options.triangle = true;
        options.maxDistance = most;
        options.without = left;
        const SceneResult some = scene.query(given, configurations, options, {.threads = 1});
        expectSame(some, scene.query(given, configurations, options, {.threads = 4}));
        options.distances = true;
        expectSame(some, scene.query(given, configurations, options));
      }
  }
}

TEST(Scene, ManySurfacesAreTheNearestOfEach) {
  const std::vector<glm::dmat4> poses = spreadPoses(kMany, 3);
  const std::vector<std::shared_ptr<const Surface>>& surfaces = variousSurfaces();
  Scene scene;
  for (size_t b = 0; b < kMany; ++b)
    scene.add(std::to_string(b), surfaces[b % surfaces.size()],
              poses[b - b % 12 / 6 * 6]);  // Half are twice.
  const std::vector<glm::dvec3> points = manyPoints(1000, 4);
  std::vector<double> least(points.size(), double(INFINITY));
  std::vector<uint32_t> nearest(points.size(), kNoBody);
  std::vector<glm::dvec3> inBody(points.size());
  for (uint32_t b = 0; b < kMany; ++b) {
    for (size_t i = 0; i < points.size(); ++i) inBody[i] = movedBack(scene.poses()[b], points[i]);
    const QueryResult alone = surfaces[b % surfaces.size()]->query(inBody);
    for (size_t i = 0; i < points.size(); ++i)
      if (alone.distance[i] < least[i]) least[i] = alone.distance[i], nearest[i] = b;
  }
  const SceneResult found = scene.query(points, {.body = true});
  for (size_t i = 0; i < points.size(); ++i) {
    const bool isSomewhere = i != 2 && i != 3;
    ASSERT_EQ(found.body[i], nearest[i]) << i;
    ASSERT_EQ(found.body[i] == kNoBody, !isSomewhere) << i;
    ASSERT_TRUE(isSomewhere ? found.distance[i] == least[i] : std::isnan(found.distance[i])) << i;
  }
}

TEST(Scene, ManyBodiesMayLieFarAway) {
  for (const double far : {1e7, 1e12, 1e160}) {
    SCOPED_TRACE(far);
    std::vector<glm::dmat4> poses = spreadPoses(kMany + 1, 5);
    for (glm::dmat4& pose : poses) pose[3] += glm::dvec4(far, far, -far, 0.0);
    const Scene scene = manyBodies(true, poses);
    std::vector<glm::dvec3> points = manyPoints(1000, 6);
    for (size_t i = 0; i < points.size(); i += 2) points[i] += glm::dvec3(far, far, -far);
    expectSame(scene.query(points, kUnion), scene.query(points, kEachBody));
  }
}

TEST(Scene, IsInsideBeyondTheBoundsOfAnOpenMesh) {
  // Without its upper half, the sphere still fills a third of what a point just above its rim sees.
  const Mesh sphere = shapes::sphere(1.0, 3);
  const Mesh bowl =
      keepTriangles(sphere, [&](const glm::uvec3& t) { return sphere.position(t.x).z < -0.01; });
  Scene scene;
  scene.add("bowl", prepared(bowl, {.threshold = 0.2}));
  scene.add("ball", prepared(sphere), glm::translate(glm::dmat4(1.0), {0.0, 0.0, 1.5}));
  const std::vector<glm::dvec3> points{{0.0, 0.0, 0.3}, {0.0, 0.0, 0.45}};
  ASSERT_LT(bounds(bowl).max.z, points[0].z);
  const SceneResult found = scene.query(points, {.body = true, .distances = true});
  EXPECT_LT(found.distances[0], 0.0);
  EXPECT_GT(found.distances[1], 0.0);
  EXPECT_EQ(scene.query(points, {.body = true}).body[0], 0u);
}

TEST(Scene, ACommonMotionChangesNothing) {
  Scene scene = variousScene(1);
  const std::vector<glm::dvec3> points = worldPoints(500, 4.0, 2);
  const SceneResult before = scene.query(points, kUnion);
  std::mt19937 random(3);
  const glm::dmat4 motion = randomPose(random, 10.0);
  std::vector<glm::dmat4> poses = scene.poses();
  for (glm::dmat4& pose : poses) pose = motion * pose;
  scene.setPoses(poses);
  std::vector<glm::dvec3> elsewhere;
  for (const glm::dvec3& p : points) elsewhere.emplace_back(motion * glm::dvec4(p, 1.0));
  const SceneResult after = scene.query(elsewhere, kUnion);
  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(after.distance[i], before.distance[i], 1e-11);
    ASSERT_EQ(after.body[i], before.body[i]);
    ASSERT_LT(glm::distance(after.closest[i], glm::dvec3(motion * glm::dvec4(before.closest[i], 1.0))), 1e-9);
    ASSERT_LT(glm::distance(after.gradient[i], glm::dvec3(motion * glm::dvec4(before.gradient[i], 0.0))),
              1e-9);
  }
}

TEST(Scene, TiesGoToTheLowestBody) {
  Scene scene;
  const auto ball = prepared(shapes::sphere(1.0, 2));
  scene.add("far", ball, glm::translate(glm::dmat4(1.0), {9.0, 0.0, 0.0}));
  for (const char* name : {"first", "second", "third"}) scene.add(name, ball);
  const SceneResult found = scene.query(worldPoints(500, 2.0, 1), {.body = true});
  EXPECT_TRUE(std::ranges::all_of(found.body, [](uint32_t body) { return body == 1; }));
}

TEST(Scene, GradientLeadsAwayFromTheSolid) {
  Scene scene;
  scene.add("box", prepared(shapes::box({-1, -1, -1}, {1, 1, 1})),
            glm::rotate(glm::translate(glm::dmat4(1.0), {0.0, 5.0, 0.0}), 0.5 * std::numbers::pi,
                        glm::dvec3(0, 0, 1)));
  const std::vector<glm::dvec3> points{{0, 7.5, 0}, {0.25, 5.75, 0}, {0, 6, 0}};
  const SceneResult found = scene.query(points, kUnion);
  EXPECT_NEAR(found.distance[0], 1.5, 1e-6);
  EXPECT_NEAR(found.distance[1], -0.25, 1e-6);
  EXPECT_LT(glm::distance(found.gradient[0], {0, 1, 0}), 1e-6);
  EXPECT_LT(glm::distance(found.gradient[1], {0, 1, 0}), 1e-6);
  EXPECT_LT(glm::distance(found.closest[1], {0.25, 6, 0}), 1e-6);
}

TEST(Scene, ManyConfigurationsAreAsOneByOne) {
  Scene scene = variousScene(0);
  constexpr size_t kCount = 7, kPoints = 100;
  const std::vector<glm::dmat4> poses = randomPoses(kCount * scene.size(), 8);
  const std::vector<glm::dvec3> points = worldPoints(kCount * kPoints, 3.0, 9);
  for (const bool hasOwnPoints : {false, true}) {
    const size_t given = hasOwnPoints ? points.size() : kPoints;
    const SceneResult all =
        scene.query(std::span(points).first(given), {poses, kCount, hasOwnPoints}, kEachBody);
    ASSERT_EQ(all.distance.size(), kCount * kPoints);
    ASSERT_EQ(all.distances.size(), kCount * kPoints * scene.size());
    for (size_t c = 0; c < kCount; ++c) {
      scene.setPoses(std::span(poses).subspan(c * scene.size(), scene.size()));
      const SceneResult one =
          scene.query(std::span(points).subspan(hasOwnPoints ? c * kPoints : 0, kPoints), kEachBody);
      for (size_t i = 0; i < kPoints; ++i) {
        const size_t k = c * kPoints + i;
        ASSERT_EQ(all.distance[k], one.distance[i]);
        ASSERT_EQ(all.body[k], one.body[i]);
        ASSERT_EQ(all.closest[k], one.closest[i]);
        ASSERT_EQ(all.gradient[k], one.gradient[i]);
        for (size_t b = 0; b < scene.size(); ++b)
          ASSERT_EQ(all.distances[k * scene.size() + b], one.distances[i * scene.size() + b]);
      }
    }
  }
}

TEST(Scene, IsTheSameForAnyNumberOfThreads) {
  const Scene scene = variousScene(2);
  constexpr size_t kCount = 15;
  const std::vector<glm::dmat4> poses = randomPoses(kCount * scene.size(), 1);
  const std::vector<glm::dvec3> points = worldPoints(400, 4.0, 3);
  const SceneResult one = scene.query(points, {poses, kCount}, kUnion, {.threads = 1});
  const SceneResult four = scene.query(points, {poses, kCount}, kUnion, {.threads = 4});
  EXPECT_TRUE(sameBits(one.distance, four.distance));
  EXPECT_TRUE(sameBits(one.body, four.body));
  EXPECT_TRUE(sameBits(one.closest, four.closest));
  EXPECT_TRUE(sameBits(one.gradient, four.gradient));
}

TEST(Scene, MorePointsThanAreAnsweredTogether) {
  Scene scene;
  scene.add("a", std::make_shared<const Field>(sceneField(shapes::sphere(1.0, 2))));
  scene.add("b", std::make_shared<const Field>(sceneField(shapes::sphere(0.5, 2))));
  constexpr size_t kCount = 600, kPoints = 1000;
  const std::vector<glm::dmat4> poses = randomPoses(kCount * scene.size(), 1);
  const std::vector<glm::dvec3> points = worldPoints(kPoints, 3.0, 3);
  const SceneResult all = scene.query(points, {poses, kCount}, SceneOptions{.body = true, .distances = true});
  const std::span<const glm::dmat4> last = std::span(poses).last(scene.size());
  const SceneResult one = scene.query(points, {last, 1}, SceneOptions{.body = true, .distances = true});
  EXPECT_TRUE(std::equal(one.distance.begin(), one.distance.end(), all.distance.end() - kPoints));
  EXPECT_TRUE(std::equal(one.body.begin(), one.body.end(), all.body.end() - kPoints));
  EXPECT_TRUE(std::equal(one.distances.begin(), one.distances.end(), all.distances.end() - 2 * kPoints));
}

TEST(Scene, AFieldIsSampled) {
  const Mesh ball = shapes::sphere(1.0, 3);
  const auto field = std::make_shared<const Field>(sceneField(ball));
  const auto band = std::make_shared<const Field>(toSparse(*field));
  std::mt19937 random(1);
  const glm::dmat4 pose = randomPose(random, 1.0), other = randomPose(random, 1.0);
  Scene scene;
  scene.add("dense", field, pose);
  scene.add("sparse", band, other);
  scene.add("surface", prepared(ball), glm::translate(glm::dmat4(1.0), {2.5, 0.0, 0.0}));
  const std::vector<glm::dvec3> points = worldPoints(1000, 2.0, 4);
  const SceneResult found = scene.query(points, kEachBody), some = scene.query(points, kUnion);
  EXPECT_TRUE(sameBits(found.distance, some.distance));
  EXPECT_TRUE(sameBits(found.closest, some.closest));
  std::vector<glm::dvec3> inDense, inSparse;
  for (const glm::dvec3& p : points) {
    inDense.emplace_back(glm::inverse(pose) * glm::dvec4(p, 1.0));
    inSparse.emplace_back(glm::inverse(other) * glm::dvec4(p, 1.0));
  }
  const Samples dense = sample(*field, inDense, {.gradients = true}), sparse = sample(*band, inSparse);
  for (size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(found.distances[3 * i], dense.distance[i], 1e-6);
    ASSERT_NEAR(found.distances[3 * i + 1], sparse.distance[i], 1e-6);
    if (found.body[i] != 0) continue;
    const glm::dvec3 gradient(pose * glm::dvec4(dense.gradient[i], 0.0));
    ASSERT_LT(glm::distance(found.gradient[i], gradient), 1e-4);
    ASSERT_NEAR(glm::distance(found.closest[i], points[i]), std::abs(found.distance[i]), 1e-9);
    // At the middle, the direction is anyone's guess.
    if (const double depth = glm::length(inDense[i]); depth > 0.5 && depth < 1.1) {
      ASSERT_NEAR(glm::length(glm::dvec3(glm::inverse(pose) * glm::dvec4(found.closest[i], 1.0))), 1.0, 0.03);
    }
  }
}

TEST(Scene, WhatIsUnknownIsNaN) {
  const Mesh ball = shapes::sphere(1.0, 2);
  Field torn = sceneField(ball);
  std::ranges::fill(torn.distance, NAN);
  Scene scene;
  scene.add("ball", prepared(ball));
  const std::vector<glm::dvec3> points{{double(NAN), 0, 0}, {0, double(INFINITY), 0}, {0, 0, 3}, {0, 0, 0.5}};
  SceneResult found = scene.query(points, kEachBody);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(std::isnan(found.distance[i]) && std::isnan(found.distances[i]));
    EXPECT_EQ(found.body[i], kNoBody);
    EXPECT_TRUE(std::isnan(found.closest[i].x) && std::isnan(found.gradient[i].z));
  }
  EXPECT_EQ(found.body[2], 0u);
  scene.add("torn", std::make_shared<const Field>(std::move(torn)));
  for (const SceneOptions& options : {kUnion, kEachBody}) {
    found = scene.query(points, options);
    EXPECT_TRUE(std::isnan(found.distance[3]));
    EXPECT_EQ(found.body[3], kNoBody);
    EXPECT_TRUE(std::isnan(found.closest[3].x));
  }
  EXPECT_LT(found.distances[6], 0.0);
}

TEST(Scene, ASampleThatIsNaNCountsFarAway) {
  const Mesh ball = shapes::sphere(1.0, 2);
  Field torn = sceneField(ball);
  torn.distance[torn.distance.size() - 1] = NAN;
  Scene scene;
  scene.add("ball", prepared(ball), glm::translate(glm::dmat4(1.0), {6.0, 6.0, 6.0}));
  scene.add("torn", std::make_shared<const Field>(std::move(torn)));
  const std::vector<glm::dvec3> points{{5, 5, 5}, {5, 5, -5}};
  const SceneResult found = scene.query(points, kUnion);
  EXPECT_TRUE(std::isnan(found.distance[0]));
  EXPECT_EQ(found.body[0], kNoBody);
  EXPECT_FALSE(std::isnan(found.distance[1]));
}

TEST(Scene, FarPointsAreFar) {
  Scene scene;
  const auto ball = prepared(shapes::sphere(1.0, 2));
  scene.add("a", ball);
  scene.add("b", ball, glm::translate(glm::dmat4(1.0), {1e200, 0.0, 0.0}));
  const std::vector<glm::dvec3> points{{2e200, 0, 0}, {1e160, 0, 0}, {1e12, 0, 0}};
  const SceneResult found = scene.query(points, {.body = true});
  EXPECT_EQ(found.body[0], 1u);
  EXPECT_NEAR(found.distance[0] / 1e200, 1.0, 1e-6);
  EXPECT_EQ(found.body[1], 0u);
  EXPECT_EQ(found.body[2], 0u);
}

TEST(Scene, WithoutBodiesAllIsFar) {
  const Scene scene;
  const std::vector<glm::dvec3> points{{0, 0, 0}, {double(NAN), 0, 0}};
  const SceneResult found = scene.query(points, kEachBody);
  EXPECT_EQ(found.distance[0], double(INFINITY));
  EXPECT_TRUE(std::isnan(found.distance[1]));
  EXPECT_EQ(found.body[0], kNoBody);
  EXPECT_TRUE(std::isnan(found.closest[0].x) && std::isnan(found.gradient[0].x));
  EXPECT_TRUE(found.distances.empty());
  EXPECT_EQ(scene.query(points, Configurations{.count = 3}).distance.size(), 6u);
}

TEST(Scene, SharesItsSurfaces) {
  auto ball = prepared(shapes::sphere(1.0, 2));
  const std::weak_ptr<const Surface> watched = ball;
  Scene scene;
  scene.add("a", ball);
  scene.add("b", std::move(ball), glm::translate(glm::dmat4(1.0), {5.0, 0.0, 0.0}));
  EXPECT_EQ(watched.use_count(), 2);
  scene.remove("a");
  EXPECT_EQ(scene.names(), std::vector<std::string>{"b"});
  EXPECT_EQ(scene.number("b"), 0u);
  EXPECT_NEAR(scene.query(std::vector<glm::dvec3>{{5, 0, 3}}).distance[0], 2.0, 0.05);
  scene.remove("b");
  EXPECT_TRUE(watched.expired());
}

std::string usageMessage(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Usage);
    return error.what();
  }
  return "nothing";
}

TEST(Scene, SaysWhatIsWrongWithAPose) {
  const auto ball = prepared(shapes::sphere(1.0, 1));
  Scene scene;
  scene.add("base", ball);
  scene.add("hand", ball);
  const glm::dmat4 none(1.0);
  const auto poseWith = [&](int column, int row, double value) {
    glm::dmat4 pose(1.0);
    pose[column][row] = value;
    return pose;
  };
  const auto check = [&](const glm::dmat4& pose, const std::string& wrong) {
    const std::string alone = usageMessage([&] { scene.setPose("hand", pose); });
    EXPECT_TRUE(contains(alone, "the pose of body 'hand' is no scaled rigid motion: it " + wrong));
    EXPECT_EQ(usageMessage([&] { scene.setPoses(std::vector{none, pose}); }), alone);
    EXPECT_TRUE(contains(usageMessage([&] { scene.add("arm", ball, pose); }), wrong));
    const std::vector<glm::dmat4> poses{none, none, none, pose};
    EXPECT_TRUE(
        contains(usageMessage([&] {
                   scene.query(PointsView(), Configurations{poses, 2});
                 }),
                 "the pose of body 'hand' in configuration 1 is no scaled rigid motion: it " + wrong));
  };
  check(poseWith(3, 1, double(NAN)), "has a number that is not finite in row 1, column 3");
  check(poseWith(0, 2, double(INFINITY)), "has a number that is not finite in row 2, column 0");
  check(poseWith(1, 3, 2.5), "has the last row 0 2.5 0 1 instead of 0 0 0 1");
  check(glm::scale(none, glm::dvec3(1.0, 2.0, 1.0)),
        "scales unevenly: its x axis has the length 1, and its y axis 2");
  check(glm::scale(none, glm::dvec3(0.0)), "has a scale of 0");
  check(poseWith(0, 0, 1.00002), "scales unevenly");
  glm::dmat4 sheared(1.0);
  sheared[2] = {0.0, std::sin(0.1), std::cos(0.1), 0.0};
  check(sheared, "shears: its y and z axes are not perpendicular");
  check(glm::scale(none, glm::dvec3(1.0, 1.0, -1.0)), "mirrors: its axes are left-handed");
  EXPECT_EQ(scene.size(), 2u);
  EXPECT_EQ(scene.poses(), std::vector({none, none}));
  EXPECT_EQ(usageMessage([&] { scene.setPose("hand", poseWith(0, 0, 1.000004)); }), "nothing");
}

TEST(Scene, SaysWhatIsWrongWithACall) {
  const Mesh mesh = shapes::sphere(1.0, 1);
  const auto ball = prepared(mesh);
  Scene scene;
  EXPECT_EQ(usageMessage([&] { scene.remove("arm"); }), "the scene has no body 'arm'; it has none");
  scene.add("base", ball);
  scene.add("hand", ball);
  EXPECT_EQ(usageMessage([&] { scene.setPose("arm", glm::dmat4(1.0)); }),
            "the scene has no body 'arm'; it has 'base', 'hand'");
  EXPECT_TRUE(contains(usageMessage([&] { scene.add("hand", ball); }), "the scene has a body 'hand'"));
  EXPECT_TRUE(contains(usageMessage([&] { scene.add("", ball); }), "a name"));
  EXPECT_TRUE(contains(usageMessage([&] { scene.add("x", std::shared_ptr<Surface>()); }), "no surface"));
  EXPECT_TRUE(contains(usageMessage([&] { scene.add("x", std::shared_ptr<Field>()); }), "no field"));
  EXPECT_TRUE(contains(usageMessage([&] { scene.add("x", std::make_shared<Field>()); }), "no distances"));
  EXPECT_TRUE(contains(usageMessage([&] { scene.setPoses(std::vector{glm::dmat4(1.0)}); }),
                       "1 poses are given for 2 bodies"));
  const std::vector<glm::dmat4> poses(4, glm::dmat4(1.0));
  const std::vector<glm::dvec3> points(5, glm::dvec3(0.0));
  EXPECT_EQ(usageMessage([&] {
              scene.query(points, Configurations{poses, 3});
            }),
            "there are 4 poses for 3 configurations of 2 bodies");
  EXPECT_EQ(usageMessage([&] {
              scene.query(points, Configurations{poses, 2, true});
            }),
            "5 points are not as many in each of 2 configurations");
  EXPECT_EQ(scene.query(points, Configurations{{}, 0}).distance.size(), 0u);
}

/// Two balls of radius 1 about 0 and about (4, 0, 0), and the field of one about (0, 4, 0).
Scene threeBalls() {
  const Mesh ball = shapes::sphere(1.0, 3);
  Scene scene;
  scene.add("left", prepared(ball));
  scene.add("right", prepared(ball), glm::translate(glm::dmat4(1.0), {4.0, 0.0, 0.0}));
  scene.add("field", std::make_shared<const Field>(sceneField(ball)),
            glm::translate(glm::dmat4(1.0), {0.0, 4.0, 0.0}));
  return scene;
}

TEST(Scene, BodiesAreLeftOut) {
  const Scene scene = threeBalls();
  const std::vector<glm::dvec3> points{{1.5, 0, 0}, {3.5, 0, 0}, {0, 2.5, 0}, {double(NAN), 0, 0}};
  const uint32_t left[] = {0}, both[] = {2, 0};
  const SceneResult all = scene.query(points, kEachBody);
  SceneOptions options = kEachBody;
  options.without = left;
  const SceneResult some = scene.query(points, options);
  options.distances = false;
  options.without = both;
  const SceneResult one = scene.query(points, options);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(std::isnan(some.distances[3 * i]));
    EXPECT_EQ(some.distances[3 * i + 1], all.distances[3 * i + 1]);
    EXPECT_EQ(some.distance[i], std::min(all.distances[3 * i + 1], all.distances[3 * i + 2]));
    EXPECT_EQ(one.distance[i], all.distances[3 * i + 1]);
    EXPECT_EQ(one.body[i], 1u);
  }
  EXPECT_EQ(some.body[2], 2u);
  EXPECT_TRUE(std::isnan(some.distance[3]));
  const uint32_t none[] = {3};
  options.without = none;
  EXPECT_EQ(usageMessage([&] { scene.query(points, options); }),
            "body 3 is to be left out, but the scene has 3");
}

TEST(Scene, DistancesAreLimited) {
  const Scene scene = threeBalls();
  // Near both kinds of bodies, far from all, and deep in both.
  const std::vector<glm::dvec3> points{{1.25, 0, 0}, {0, 2.75, 0}, {0, 0, 9}, {4, 0, 0}, {0, 4, 0}};
  SceneOptions options = kEachBody;
  options.triangle = true;
  const SceneResult all = scene.query(points, options);
  options.maxDistance = 0.5;
  for (const bool each : {true, false}) {
    options.distances = each;
    const SceneResult found = scene.query(points, options);
    for (size_t i = 0; i < points.size(); ++i)
      EXPECT_EQ(found.distance[i], std::clamp(all.distance[i], -0.5, 0.5));
    for (size_t k = 0; each && k < found.distances.size(); ++k)
      EXPECT_EQ(found.distances[k], std::clamp(all.distances[k], -0.5, 0.5));
    for (const size_t i : {0, 1}) {
      EXPECT_EQ(found.body[i], i == 0 ? 0u : 2u);
      EXPECT_EQ(found.closest[i], all.closest[i]);
      EXPECT_EQ(found.gradient[i], all.gradient[i]);
      EXPECT_EQ(found.triangle[i], all.triangle[i]);
    }
    EXPECT_NE(found.triangle[0], kNoTriangle);
    for (const size_t i : {2, 3, 4}) {
      EXPECT_TRUE(std::isnan(found.closest[i].x) && std::isnan(found.gradient[i].x));
      EXPECT_EQ(found.triangle[i], kNoTriangle);
    }
    EXPECT_EQ(found.body[2], kNoBody);
    EXPECT_EQ(found.body[3], 1u);
    EXPECT_EQ(found.body[4], 2u);
  }
  EXPECT_EQ(all.triangle[1], kNoTriangle);  // Of a field
  options.maxDistance = 0.0;
  EXPECT_EQ(usageMessage([&] { scene.query(points, options); }),
            "the largest distance of a query must be above 0, not 0");
}

TEST(Scene, CanBeCancelled) {
  const Scene scene = variousScene(1);
  const std::vector<glm::dvec3> points = worldPoints(100, 2.0, 1);
  double last = 0.0;
  const SceneResult found =
      scene.query(points, SceneOptions{}, {.progress = [&](std::string_view, double done) {
                    EXPECT_GE(done, last);
                    last = done;
                    return true;
                  }});
  EXPECT_EQ(last, 1.0);
  EXPECT_EQ(codeOf([&] {
              scene.query(points, SceneOptions{},
                          {.progress = [](std::string_view, double) { return false; }});
            }),
            ErrorCode::Cancelled);
}

/// Returns the mesh of a body, moved into the world.
Mesh movedMesh(Mesh mesh, const glm::dmat4& pose) {
  for (glm::vec3& v : mesh.vertices) v = glm::vec3(pose * glm::dvec4(mesh.origin + glm::dvec3(v), 1.0));
  mesh.origin = glm::dvec3(0.0);
  return mesh;
}

TEST(Scene, ScalesBodies) {
  const std::vector<Mesh> meshes{shapes::box({-0.5, -0.3, -1}, {0.5, 0.3, 1}),
                                 shapes::torus(1.0, 0.3, 24, 12)};
  std::mt19937 random(7);
  const std::vector<glm::dvec3> points = worldPoints(500, 5.0, 8);
  for (const double scale : {0.01, 0.4, 3.0}) {
    Scene scaled, plain;
    for (int b = 0; b < 12; ++b) {  // So many that each cell chooses.
      const Mesh& mesh = meshes[size_t(b) % 2];
      const glm::dmat4 pose = glm::scale(randomPose(random, 4.0), glm::dvec3(b == 3 ? 1.0 : scale));
      scaled.add(std::to_string(b), prepared(mesh), pose);
      plain.add(std::to_string(b), prepared(movedMesh(mesh, pose)));
    }
    for (const double most : {double(INFINITY), 0.7}) {
      SceneOptions options = kEachBody;
      options.maxDistance = most;
      const SceneResult found = scaled.query(points, options), truth = plain.query(points, options);
      for (size_t i = 0; i < points.size(); ++i) {
        ASSERT_NEAR(found.distance[i], truth.distance[i], 2e-6) << i;
        if (!std::isfinite(truth.closest[i].x)) {
          ASSERT_EQ(found.distance[i], truth.distance[i]);
          ASSERT_FALSE(std::isfinite(found.closest[i].x));
          continue;
        }
        ASSERT_NEAR(glm::distance(points[i], found.closest[i]), std::abs(found.distance[i]), 2e-6);
        ASSERT_NEAR(glm::length(found.gradient[i]), 1.0, 1e-12);
        for (size_t b = 0; b < 12; ++b)
          ASSERT_NEAR(found.distances[12 * i + b], truth.distances[12 * i + b], 2e-6);
      }
      const SceneResult chosen = scaled.query(points, {.body = true, .maxDistance = most});
      EXPECT_TRUE(sameBits(chosen.distance, found.distance));
      EXPECT_TRUE(sameBits(chosen.body, found.body));
    }
    const std::vector<glm::uvec2> pairs{{0, 1}, {2, 3}, {3, 2}};
    const auto gaps = scaled.distancesBetween(pairs), truth = plain.distancesBetween(pairs);
    for (size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_NEAR(gaps[i].distance, truth[i].distance, 2e-6);
      EXPECT_NEAR(glm::distance(gaps[i].point, gaps[i].otherPoint), gaps[i].distance, 1e-9);
    }
    EXPECT_EQ(scaled.distancesBetween(pairs, 1e-9)[0].distance, std::min(1e-9, gaps[0].distance));
  }
  const Surface box(meshes[0]);
  const glm::dmat4 twice = glm::scale(glm::dmat4(1.0), glm::dvec3(2.0));
  EXPECT_NEAR(box.hausdorff(box, {.pose = twice}).distance, glm::length(glm::dvec3(0.5, 0.3, 1)), 1e-6);
}

TEST(Scene, GeneratesTheFieldOfItsUnion) {
  Scene scene = variousScene(3);
  scene.add("field", std::make_shared<const Field>(sceneField(shapes::sphere(0.5, 2))),
            glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(0, 3, 0)), glm::dvec3(1.5)));
  const Grid grid{{37, 29, 33}, {-3, -2.5, -3}, 0.17};
  const Field field = scene.generate(grid), clamped = scene.generate(grid, 2.0, {.threads = 1});
  const Field band = scene.generateBand(grid, {.outside = 2.0, .inside = 3.0});
  validate(band);
  EXPECT_EQ(clamped.clampDistance, 2.0 * grid.spacing);
  size_t inside = 0;
  for (int z = 0; z < grid.dims.z; ++z)
    for (int y = 0; y < grid.dims.y; ++y)
      for (int x = 0; x < grid.dims.x; ++x) {
        const glm::dvec3 p = grid.position(glm::dvec3(x, y, z));
        const double truth = scene.query(PointsView(&p.x, 1)).distance[0];
        const float dense = field.distance[grid.index({x, y, z})];
        ASSERT_EQ(dense, float(truth));
        ASSERT_EQ(clamped.distance[grid.index({x, y, z})],
                  float(std::clamp(truth, -clamped.clampDistance, clamped.clampDistance)));
        ASSERT_EQ(band.distanceAt({x, y, z}), float(std::clamp(truth, -3.0 * 0.17, 2.0 * 0.17)));
        inside += dense < 0.0f;
      }
  EXPECT_GT(inside, 100u);
  const Grid fine{{400, 400, 400}, {-4, -4, -4}, 0.02};
  Scene closed;
  closed.add("box", prepared(shapes::box({-1, -1, -1}, {1, 1, 1})), randomPoses(1, 4)[0]);
  closed.add("ball", prepared(shapes::sphere(1.0, 3)));
  const Field fineBand = closed.generateBand(fine);
  validate(fineBand);
  EXPECT_FALSE(fineBand.narrow->tiles.empty());
  const std::vector<glm::dvec3> points = worldPoints(3000, 3.9, 5);
  for (const glm::dvec3& p : points) {
    const glm::ivec3 sample((p - fine.origin) / fine.spacing);
    const glm::dvec3 at = fine.position(glm::dvec3(sample));
    const double truth = closed.query(PointsView(&at.x, 1)).distance[0];
    ASSERT_EQ(fineBand.distanceAt(sample), float(std::clamp(truth, -0.06, 0.06)));
  }
  EXPECT_EQ(codeOf([&] { closed.generateBand(fine, {.winding = true}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { closed.generate(grid, -1.0); }), ErrorCode::Usage);
  EXPECT_TRUE(closed.bounds().max.x >= 1.0 && Scene().bounds().isEmpty());
  EXPECT_EQ(Scene().generate(grid).distance[0], INFINITY);
}

}  // namespace
}  // namespace raymap
