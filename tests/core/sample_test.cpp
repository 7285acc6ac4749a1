#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <cmath>
#include <limits>
#include <random>

#include "shapes.h"

namespace raymap {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A field with a value for each position.
template <class Function>
Field fieldOf(const Grid& grid, Function&& function) {
  Field field{.grid = grid, .distance = Buffer<float>(grid.sampleCount())};
  for (int k = 0; k < grid.dims.z; ++k)
    for (int j = 0; j < grid.dims.y; ++j)
      for (int i = 0; i < grid.dims.x; ++i)
        field.distance[grid.index({i, j, k})] = float(function(grid.position({i, j, k})));
  return field;
}

const Grid kGrid{.dims = {9, 7, 5}, .origin = {10.0, -4.0, 2.5}, .spacing = 0.25};

TEST(Sample, IsExactForTrilinearFunctions) {
  const auto function = [](const glm::dvec3& p) {
    return 0.5 * p.x - 2.0 * p.y + p.z + 0.25 * p.x * p.y * p.z;
  };
  const Field field = fieldOf(kGrid, function);
  std::mt19937 random(1);
  for (int n = 0; n < 200; ++n) {
    glm::dvec3 s;
    for (int a = 0; a < 3; ++a) s[a] = std::uniform_real_distribution<>(0.0, kGrid.dims[a] - 1.0)(random);
    const glm::dvec3 p = kGrid.position(s);
    EXPECT_NEAR(distanceAt(field, p), function(p), 1e-5);
  }
}

TEST(Sample, GivesTheSamplesThemselves) {
  const Field field = fieldOf(kGrid, [](const glm::dvec3& p) { return std::sin(40.0 * p.x + p.y * p.z); });
  for (const glm::ivec3 s : {glm::ivec3(0), glm::ivec3(3, 2, 1), kGrid.dims - 1})
    EXPECT_EQ(float(distanceAt(field, kGrid.position(s))), field.distance[kGrid.index(s)]);
}

TEST(Sample, HasAGradientWithoutUnits) {
  const Field field = fieldOf(kGrid, [](const glm::dvec3& p) { return 0.6 * p.x + 0.8 * p.z; });
  const glm::dvec3 g = gradientAt(field, kGrid.position({4.3, 3.1, 1.6}));
  EXPECT_NEAR(g.x, 0.6, 1e-5);
  EXPECT_NEAR(g.y, 0.0, 1e-5);
  EXPECT_NEAR(g.z, 0.8, 1e-5);
}

TEST(Sample, PointsAwayFromASphere) {
  const Field field =
      generate(shapes::sphere(1.0, 4), fitGrid(shapes::sphere(1.0, 4), {.resolution = 48}), {.device = "cpu"})
          .field;
  for (const glm::dvec3 p :
       {glm::dvec3(0.7, 0.1, -0.2), glm::dvec3(0.1, 1.05, 0.2), glm::dvec3(0.5, 0.5, 0.5)}) {
    EXPECT_NEAR(distanceAt(field, p), glm::length(p) - 1.0, 0.01);
    EXPECT_LT(glm::distance(gradientAt(field, p), glm::normalize(p)), 0.02);
  }
}

TEST(Sample, BoundsTheDistanceOutsideFromBelow) {
  const auto ball = [](const glm::dvec3& p) { return glm::distance(p, glm::dvec3(11.0, -3.2, 3.0)) - 0.3; };
  const Field field = fieldOf(kGrid, ball);
  const glm::dvec3 last = kGrid.position(kGrid.dims - 1);
  std::mt19937 random(2);
  std::uniform_real_distribution<> far(-5.0, 5.0);
  for (int n = 0; n < 500; ++n) {
    const glm::dvec3 p =
        kGrid.position(0.5 * glm::dvec3(kGrid.dims)) + glm::dvec3(far(random), far(random), far(random));
    const glm::dvec3 q = glm::clamp(p, kGrid.origin, last);
    if (q == p) continue;
    const double bound = distanceAt(field, p), there = distanceAt(field, q);
    EXPECT_NEAR(bound, std::hypot(glm::distance(p, q), std::max(there, 0.0)), 1e-9);
    EXPECT_LE(bound, ball(p) + 0.02);
    EXPECT_GT(bound, 0.0);
  }
}

/// The solid ends at the box, whatever the samples there say.
TEST(Sample, IsPositiveOutsideOfASolidThatReachesTheBox) {
  const Field field = fieldOf(kGrid, [](const glm::dvec3&) { return -1.0; });
  EXPECT_NEAR(distanceAt(field, kGrid.origin - glm::dvec3(0.5, 0, 0)), 0.5, 1e-12);
}

TEST(Sample, InterpolatesClampedDistancesAsTheyAre) {
  Field field = fieldOf(kGrid, [](const glm::dvec3& p) { return std::clamp(p.x - 11.0, -0.3, 0.3); });
  field.band = 0.3;
  EXPECT_NEAR(distanceAt(field, kGrid.position({7.5, 3, 2})), 0.3, 1e-6);
  EXPECT_NEAR(glm::length(gradientAt(field, kGrid.position({7.0, 3, 2}))), 0.0, 1e-6);
  EXPECT_NEAR(distanceAt(field, kGrid.position({4.5, 3, 2})), 0.125, 1e-6);
}

TEST(Sample, PassesOnWhatIsNotANumber) {
  Field field = fieldOf(kGrid, [](const glm::dvec3&) { return 1.0; });
  field.distance[kGrid.index({2, 2, 2})] = float(kNaN);
  EXPECT_TRUE(std::isnan(distanceAt(field, kGrid.position({1.5, 2.5, 1.5}))));
  EXPECT_FALSE(std::isnan(distanceAt(field, kGrid.position({4.5, 4.5, 1.5}))));
  EXPECT_TRUE(std::isnan(distanceAt(field, {kNaN, 0, 0})));
  EXPECT_TRUE(std::isnan(gradientAt(field, {kNaN, 0, 0}).x));
  EXPECT_EQ(distanceAt(field, {INFINITY, 0, 0}), INFINITY);
}

TEST(Sample, ReadsGridsOfOneSample) {
  const Field point{.grid = {.dims = {1, 1, 1}, .spacing = 2.0}, .distance = [] {
                      Buffer<float> one(1);
                      one[0] = 3.0f;
                      return one;
                    }()};
  EXPECT_EQ(distanceAt(point, {0, 0, 0}), 3.0);
  EXPECT_NEAR(distanceAt(point, {4, 0, 0}), 5.0, 1e-12);
}

TEST(Sample, GivesManyPointsTheSameAndReusesItsMemory) {
  const Field field = fieldOf(kGrid, [](const glm::dvec3& p) { return p.x * p.y - p.z; });
  std::mt19937 random(3);
  std::uniform_real_distribution<> place(-1.0, 12.0);
  std::vector<glm::dvec3> points;
  for (int n = 0; n < 5000; ++n) points.emplace_back(place(random), place(random), place(random));
  Samples one, all;
  sample(field, points, {.gradients = true, .threads = 1}, one);
  const float* const memory = one.distance.data();
  sample(field, std::span(points).first(10), {}, one);
  EXPECT_EQ(one.distance.size(), 10u);
  EXPECT_TRUE(one.gradient.empty());
  sample(field, points, {.gradients = true}, one);
  EXPECT_EQ(one.distance.data(), memory);
  all = sample(field, points, {.gradients = true});
  for (size_t n = 0; n < points.size(); ++n) {
    ASSERT_EQ(one.distance[n], all.distance[n]);
    ASSERT_EQ(one.distance[n], float(distanceAt(field, points[n])));
    ASSERT_EQ(one.gradient[n], glm::vec3(gradientAt(field, points[n])));
  }
}

TEST(Sample, RefusesAFieldWithoutDistances) {
  EXPECT_THROW(distanceAt({}, glm::dvec3(0)), Error);
  EXPECT_THROW(gradientAt({.grid = kGrid}, glm::dvec3(0)), Error);
  EXPECT_THROW(sample({}, {}), Error);
}

TEST(Isosurface, ReusesTheMemoryOfItsResult) {
  const Field field = fieldOf(kGrid, [](const glm::dvec3& p) {
    return glm::distance(p, {11, -3.2, 3}) - 0.3;
  });
  Mesh mesh = isosurface(field);
  const Mesh again = mesh;
  const glm::vec3* const memory = mesh.vertices.data();
  isosurface(field, {}, mesh);
  EXPECT_EQ(mesh.vertices.data(), memory);
  EXPECT_EQ(mesh.vertices, again.vertices);
  EXPECT_EQ(mesh.triangles, again.triangles);
  EXPECT_THROW(isosurface(field, {.iso = -5.0}, mesh), Error);
  EXPECT_TRUE(mesh.triangles.empty());
}

}  // namespace
}  // namespace raymap
