#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <utility>

#include "analytic_fields.h"
#include "broken_meshes.h"
#include "error_code.h"
#include "field_kinds.h"
#include "reference.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class Sample : public EachKind {
 protected:
  /// A field with a value for each position.
  static Field fieldOf(const Grid& grid, const std::function<double(const glm::dvec3&)>& function) {
    return made(analytic::sampled(grid, function));
  }
  /// A field of one sample with distance 3, at the origin, in the units of its spacing of 2.
  static Field oneSample(const Box& surfaceBounds = {}) {
    Field field = fieldOf({.dims = {1, 1, 1}, .spacing = 2.0}, [](const glm::dvec3&) { return 3.0; });
    field.surfaceBounds = surfaceBounds;
    return field;
  }
};

INSTANTIATE_TEST_SUITE_P(Fields, Sample, kEachKind, nameOfKind);

const Grid kGrid{.dims = {9, 7, 5}, .origin = {10.0, -4.0, 2.5}, .spacing = 0.25};

TEST_P(Sample, IsExactForTrilinearFunctions) {
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

TEST_P(Sample, GivesTheSamplesThemselves) {
  const Field field = fieldOf(kGrid, [](const glm::dvec3& p) { return std::sin(40.0 * p.x + p.y * p.z); });
  for (const glm::ivec3 s : {glm::ivec3(0), glm::ivec3(3, 2, 1), kGrid.dims - 1})
    EXPECT_EQ(float(distanceAt(field, kGrid.position(s))), field.distanceAt(s));
}

TEST_P(Sample, HasAGradientWithoutUnits) {
  const Field field = fieldOf(kGrid, [](const glm::dvec3& p) { return 0.6 * p.x + 0.8 * p.z; });
  const glm::dvec3 g = gradientAt(field, kGrid.position({4.3, 3.1, 1.6}));
  EXPECT_NEAR(g.x, 0.6, 1e-5);
  EXPECT_NEAR(g.y, 0.0, 1e-5);
  EXPECT_NEAR(g.z, 0.8, 1e-5);
}

TEST_P(Sample, PointsAwayFromASphere) {
  const Mesh ball = shapes::sphere(1.0, 4);
  const Field field = made(generate(ball, fitGrid(ball, {.resolution = 48}), {}, {.device = "cpu"}).field);
  for (const glm::dvec3 p :
       {glm::dvec3(0.7, 0.1, -0.2), glm::dvec3(0.1, 1.05, 0.2), glm::dvec3(0.5, 0.5, 0.5)}) {
    EXPECT_NEAR(distanceAt(field, p), glm::length(p) - 1.0, 0.01);
    EXPECT_LT(glm::distance(gradientAt(field, p), glm::normalize(p)), 0.02);
  }
}

TEST_P(Sample, BoundsTheDistanceOutsideFromBelow) {
  const glm::dvec3 centre(11.0, -3.2, 3.0);
  const auto ball = [&](const glm::dvec3& p) { return glm::distance(p, centre) - 0.3; };
  Field field = fieldOf(kGrid, ball);
  field.surfaceBounds = {centre - 0.3, centre + 0.3};
  const glm::dvec3 last = kGrid.position(kGrid.dims - 1);
  std::mt19937 random(2);
  std::uniform_real_distribution<> far(-5.0, 5.0);
  for (int n = 0; n < 500; ++n) {
    const glm::dvec3 p =
        kGrid.position(0.5 * glm::dvec3(kGrid.dims)) + glm::dvec3(far(random), far(random), far(random));
    const glm::dvec3 q = glm::clamp(p, kGrid.origin, last);
    if (q == p) continue;
    const double bound = distanceAt(field, p), there = distanceAt(field, q);
    const double least = std::max(there - 0.7072 * kGrid.spacing, 0.0);
    EXPECT_GE(bound, std::hypot(glm::distance(p, q), least) - 1e-9);
    EXPECT_LE(bound, ball(p) + 1e-6);
  }
}

TEST_P(Sample, KnowsOutsideWhatTheBoundsOfTheSurfaceTell) {
  const glm::dvec3 p(4, 0, 0);
  EXPECT_DOUBLE_EQ(distanceAt(oneSample(), p), 3.0 - 4.0);
  EXPECT_DOUBLE_EQ(distanceAt(oneSample({glm::dvec3(0), glm::dvec3(0)}), p), 5.0);     // Held: Pythagoras.
  EXPECT_DOUBLE_EQ(distanceAt(oneSample({glm::dvec3(-9), glm::dvec3(9)}), p), -1.0);   // It may be here.
  EXPECT_DOUBLE_EQ(distanceAt(oneSample({glm::dvec3(-1), glm::dvec3(1.5)}), p), 2.5);  // Not here.
  EXPECT_DOUBLE_EQ(distanceAt(oneSample({{0, 3, 4}, {9, 3, 4}}), p), 5.0);             // Beside the grid.
  EXPECT_DOUBLE_EQ(distanceAt(oneSample({{-9, 3, 0}, {9, 9, 0}}), {0, 1, 0}), 2.0);  // The sample knows more.
  EXPECT_DOUBLE_EQ(distanceAt(oneSample({{4, -1, -1}, {4, 1, 1}}), p), -1.0);        // On their border.
  EXPECT_EQ(distanceAt(oneSample(), glm::dvec3(INFINITY, 0, 0)), -INFINITY);
  EXPECT_EQ(distanceAt(oneSample({glm::dvec3(0), glm::dvec3(0)}), glm::dvec3(INFINITY, 0, 0)), INFINITY);
  EXPECT_DOUBLE_EQ(distanceAt(oneSample(), {1e300, 0, 0}), -1e300);
}

TEST_P(Sample, IsNaNOutsideOnRequest) {
  const Field field = fieldOf(kGrid, [](const glm::dvec3& p) { return p.x - 11.0; });
  const glm::dvec3 last = kGrid.position(kGrid.dims - 1);
  const std::vector<glm::dvec3> points{kGrid.origin,
                                       last,
                                       last + glm::dvec3(0, 0, 1e-9),
                                       kGrid.origin - glm::dvec3(0, 1e-9, 0),
                                       {1e100, 0, 0}};
  const Samples samples = sample(field, points, {.gradients = true, .outside = Outside::NaN});
  const Samples bounds = sample(field, points, {.gradients = true});
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(std::isnan(samples.distance[i]), i > 1) << i;
    EXPECT_EQ(std::isnan(samples.gradient[i].y), i > 1) << i;
    EXPECT_EQ(std::isnan(distanceAt(field, points[i], Outside::NaN)), i > 1) << i;
    EXPECT_EQ(std::isnan(gradientAt(field, points[i], Outside::NaN).x), i > 1) << i;
    EXPECT_FALSE(std::isnan(bounds.distance[i]) || std::isnan(bounds.gradient[i].x)) << i;
    if (i < 2) {
      EXPECT_EQ(samples.distance[i], bounds.distance[i]);
    }
  }
}

/// Checks, in boxes that cut a mesh, that no distance outside exceeds the true one.
void expectBounds(FieldKind kind, const Mesh& mesh, const FieldOptions& options, unsigned seed) {
  std::mt19937 random(seed);
  const Box all = bounds(mesh);
  const glm::dvec3 size = all.size();
  const auto place = [&](double reach) {
    std::uniform_real_distribution<> share(-reach, 1.0 + reach);
    return all.min + size * glm::dvec3(share(random), share(random), share(random));
  };
  for (int n = 0; n < 12; ++n) {
    GridOptions gridOptions{.resolution = 14};
    if (n > 0) {
      const glm::dvec3 a = place(0.2), b = place(0.2);
      gridOptions.box = Box{glm::min(a, b), glm::max(a, b)};
    }
    Field field = inKind(kind, generate(mesh, fitGrid(mesh, gridOptions), options, {.device = "cpu"}).field);
    const double tolerance = 2e-6 * glm::length(size);
    for (int k = 0; k < 60; ++k) {
      const glm::dvec3 p = place(k % 3 == 0 ? 5.0 : 0.3);
      if (std::isnan(distanceAt(field, p, Outside::NaN))) {
        const bool isInside = std::abs(reference::windingNumber(mesh, p)) > 0.5;
        const double truth = (isInside != options.invert ? -1.0 : 1.0) * reference::distance(mesh, p);
        const double bound = distanceAt(field, p);
        ASSERT_LE(bound, truth + tolerance) << "box " << n << ", point " << k;
        ASSERT_LE(sample(field, {&p, 1}).distance[0], bound);
        const Box known = std::exchange(field.surfaceBounds, {});
        ASSERT_LE(distanceAt(field, p), bound);
        field.surfaceBounds = known;
      }
    }
  }
}

TEST_P(Sample, BoundsTheDistanceOutsideOfBoxesThatCutTheMesh) {
  const Mesh apart = shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::sphere(0.5, 2, {4, 1, 0}));
  unsigned seed = 1;
  for (const Mesh& mesh : {apart, shapes::torus(1.0, 0.3, 30, 16), shapes::box({0, 0, 0}, {1, 3, 2})})
    for (const bool invert : {false, true})
      for (const double band : {0.0, 2.0})
        expectBounds(GetParam(), mesh, {.band = band, .invert = invert}, seed++);
}

TEST_P(Sample, TakesNoBoundFromSamplesThatAreClampedInside) {
  for (const double clamp : {1.0, 1.5}) {
    Field field = analytic::sampled(kGrid, [](const glm::dvec3&) { return -1.0; });
    field.clampDistance = clamp;
    EXPECT_EQ(distanceAt(made(std::move(field)), kGrid.position({-1, 3, 2})) == -INFINITY, clamp == 1.0);
  }
}

TEST(SurfaceBounds, HoldThickSheetsAndClosedHoles) {
  const Mesh sheet = makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}});
  const Box thick = generate(sheet, fitGrid(sheet, {.resolution = 12, .thickness = 0.5}), {.thickness = 0.5},
                             {.device = "cpu"})
                        .field.surfaceBounds;
  EXPECT_EQ(thick.min, glm::dvec3(-0.25));
  EXPECT_EQ(thick.max, glm::dvec3(2.25, 2.25, 0.25));
  const Mesh bowl = keepTriangles(shapes::sphere(1.0, 3), [&](const glm::uvec3& t) {
    return shapes::sphere(1.0, 3).position(t.x).z < 0.0;
  });
  const Grid grid = fitGrid(bowl, {.resolution = 16, .box = Box{glm::dvec3(-2), glm::dvec3(2)}});
  const Box open = generate(bowl, grid, {}, {.device = "cpu"}).field.surfaceBounds;
  EXPECT_NEAR(open.max.x, 1.0, 0.02);
  const Box closed = generate(bowl, grid, {.closeHoles = true}, {.device = "cpu"}).field.surfaceBounds;
  EXPECT_EQ(closed.min, grid.position({0, 0, 0}));
  EXPECT_EQ(closed.max, grid.position(grid.dims - 1));
  EXPECT_TRUE(generate(bowl, grid, {.invert = true}, {.device = "cpu"}).field.surfaceBounds.isEmpty());
}

TEST_P(Sample, InterpolatesClampedDistancesAsTheyAre) {
  Field dense =
      analytic::sampled(kGrid, [](const glm::dvec3& p) { return std::clamp(p.x - 11.0, -0.3, 0.3); });
  dense.clampDistance = 0.3;
  const Field field = made(std::move(dense));
  EXPECT_NEAR(distanceAt(field, kGrid.position({7.5, 3, 2})), 0.3, 1e-6);
  EXPECT_NEAR(glm::length(gradientAt(field, kGrid.position({7.0, 3, 2}))), 0.0, 1e-6);
  EXPECT_NEAR(distanceAt(field, kGrid.position({4.5, 3, 2})), 0.125, 1e-6);
}

TEST_P(Sample, PassesOnWhatIsNotANumber) {
  Field field = fieldOf(kGrid, [](const glm::dvec3&) { return 1.0; });
  field.distance[placeOf(field, {2, 2, 2})] = float(kNaN);
  EXPECT_TRUE(std::isnan(distanceAt(field, kGrid.position({1.5, 2.5, 1.5}))));
  EXPECT_FALSE(std::isnan(distanceAt(field, kGrid.position({4.5, 4.5, 1.5}))));
  EXPECT_TRUE(std::isnan(distanceAt(field, {kNaN, 0, 0})));
  EXPECT_TRUE(std::isnan(gradientAt(field, {kNaN, 0, 0}).x));
  EXPECT_EQ(distanceAt(field, {INFINITY, 0, 0}), -INFINITY);
}

TEST_P(Sample, ReadsGridsOfOneSampleAlongAnAxis) {
  EXPECT_EQ(distanceAt(oneSample(), {0, 0, 0}), 3.0);
  const Grid flat{.dims = {30, 1, 30}, .origin = {-1.45, 0.0, -1.45}, .spacing = 0.1};
  const Field field = fieldOf(flat, [](const glm::dvec3& p) { return p.x - 2.0 * p.z; });
  EXPECT_NEAR(distanceAt(field, {0.93, 0, 0.2}), 0.53, 1e-6);
  EXPECT_NEAR(distanceAt(field, {0.5, 0, -0.8}), 2.1, 1e-6);
}

TEST_P(Sample, GivesManyPointsTheSameAndReusesItsMemory) {
  const Field field = fieldOf(kGrid, [](const glm::dvec3& p) { return p.x * p.y - p.z; });
  std::mt19937 random(3);
  std::uniform_real_distribution<> place(-1.0, 12.0);
  std::vector<glm::dvec3> points;
  for (int n = 0; n < 5000; ++n) points.emplace_back(place(random), place(random), place(random));
  Samples one, all;
  sample(field, points, {.gradients = true}, one, {.threads = 1});
  const float* const memory = one.distance.data();
  sample(field, std::span(points).first(10), {}, one);
  EXPECT_EQ(one.distance.size(), 10u);
  EXPECT_TRUE(one.gradient.empty());
  sample(field, points, {.gradients = true}, one);
  EXPECT_EQ(one.distance.data(), memory);
  all = sample(field, points, {.gradients = true});
  for (size_t n = 0; n < points.size(); ++n) {
    ASSERT_EQ(one.distance[n], all.distance[n]);
    const bool isOutside = std::isnan(distanceAt(field, points[n], Outside::NaN));
    const auto exact = distanceAt(field, points[n]);
    if (isOutside) {  // Rounded down.
      ASSERT_LE(one.distance[n], exact);
      ASSERT_GT(std::nextafter(one.distance[n], INFINITY), exact);
    } else {
      ASSERT_EQ(one.distance[n], float(exact));
    }
    ASSERT_EQ(one.gradient[n], glm::vec3(gradientAt(field, points[n])));
  }
}

TEST_P(Sample, RefusesAFieldWithoutDistances) {
  Field field = fieldOf(kGrid, [](const glm::dvec3&) { return 1.0; });
  field.distance = {};
  EXPECT_EQ(codeOf([&] { distanceAt(field, glm::dvec3(0)); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { gradientAt(field, glm::dvec3(0)); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { sample(field, {}); }), ErrorCode::Usage);
}

}  // namespace
}  // namespace raymap
