#include "repair/solid/hollow.h"

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>

#include "analytic_fields.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr double kWall = 0.5, kRadius = 0.3;
const glm::dvec3 kDown(0, 0, -1);

/// A table: a plate of 8 x 3 x 2 on two legs, the left one longer.
double table(const glm::dvec3& p) {
  const double plate = analytic::box(p - glm::dvec3(0, 0, 2), {4, 1.5, 1});
  const double left = analytic::box(p - glm::dvec3(-3, 0, -0.5), {1, 1.5, 3});
  const double right = analytic::box(p - glm::dvec3(3, 0, 0), {1, 1.5, 2.5});
  return std::min({plate, left, right});
}

Field solidTable() {
  return analytic::sampled(analytic::cube(83, 10.0), table);
}

std::vector<Hollow> hollowsOf(Field& solid, double wall, double least, size_t& filled) {
  return findHollows(solid, wall, least, kDown, filled);
}

/// Expects a hole that leaves the solid at a height, straight down or up, between two values of x.
void expectExit(const Field& solid, const DrainHole& hole, double height, double down, double lowX,
                double highX) {
  const DrainHolePlace exit = exitOf(solid, hole);
  EXPECT_NEAR(exit.position.z, height, 0.25 * solid.grid.spacing);
  EXPECT_EQ(exit.direction, glm::dvec3(0, 0, down));
  EXPECT_GT(exit.position.x, lowX);
  EXPECT_LT(exit.position.x, highX);
  EXPECT_EQ(hole.radius, kRadius);
  // Both ends are free: one in the hollow, one outside.
  EXPECT_LT(table(hole.start), -kWall + 1e-6);
  EXPECT_GT(table(hole.end), kRadius);
}

TEST(Hollow, HasAHoleInItsLowestPoint) {
  Field solid = solidTable();
  size_t filled = 0;
  const std::vector<Hollow> hollows = hollowsOf(solid, kWall, kRadius, filled);
  ASSERT_EQ(hollows.size(), 1u);
  EXPECT_EQ(filled, 0u);
  EXPECT_NEAR(hollows[0].deepest, 0.5, 0.1);
  const std::vector<DrainHole> holes = placeHoles(solid, hollows[0], 1, kRadius, kDown);
  ASSERT_EQ(holes.size(), 1u);
  expectExit(solid, holes[0], -3.5, -1, -3.5, -2.5);
}

TEST(Hollow, HasHolesThatPointExactlyAlongAnAxis) {
  const Field solid = solidTable();
  for (int k = 1; k <= 40; ++k) {
    const glm::dvec3 start(-3, 0.1 * k, 0.3), end = start - glm::dvec3(0, 0, 0.1 * k);
    EXPECT_EQ(exitOf(solid, {start, end, kRadius}).direction, kDown) << k;
    EXPECT_EQ(exitOf(solid, {end, start, kRadius}).direction, -kDown) << k;
  }
}

TEST(Hollow, HasAVentAndAHoleInTheOtherLeg) {
  Field solid = solidTable();
  size_t filled = 0;
  const std::vector<Hollow> hollows = hollowsOf(solid, kWall, kRadius, filled);
  const std::vector<DrainHole> holes = placeHoles(solid, hollows[0], 3, kRadius, kDown);
  ASSERT_EQ(holes.size(), 3u);
  expectExit(solid, holes[0], -3.5, -1, -3.5, -2.5);
  expectExit(solid, holes[1], 3.0, 1, -3.5, 3.5);
  expectExit(solid, holes[2], -2.5, -1, 2.5, 3.5);
}

TEST(Hollow, HasNoMoreHolesThanLevelFloorsApart) {
  Field solid = analytic::sampled(analytic::cube(53, 6.0), [](const glm::dvec3& p) {
    return analytic::box(p, {2.5, 1.5, 1.5});
  });
  size_t filled = 0;
  const std::vector<Hollow> hollows = hollowsOf(solid, kWall, kRadius, filled);
  const std::vector<DrainHole> holes = placeHoles(solid, hollows[0], 1000, kRadius, kDown);
  EXPECT_GT(holes.size(), 5u);
  EXPECT_LT(holes.size(), 30u);
  for (size_t a = 0; a < holes.size(); ++a)
    for (size_t b = 0; b < a; ++b)
      EXPECT_GE(glm::distance(holes[a].start, holes[b].start), 4 * kRadius - 1e-9) << a << " " << b;
}

TEST(Hollow, HasNoFloorWhereItIsSteep) {
  // A ball's floor is level up to 37 degrees from its lowest point.
  Field solid = analytic::sampled(analytic::cube(83, 10.0),
                                  [](const glm::dvec3& p) { return analytic::sphere(p, 4.0); });
  size_t filled = 0;
  const std::vector<Hollow> hollows = hollowsOf(solid, kWall, kRadius, filled);
  ASSERT_EQ(hollows.size(), 1u);
  double highest = -INFINITY, lowest = INFINITY;
  for (const glm::dvec3& floor : hollows[0].floors) {
    highest = std::max(highest, solid.grid.position(floor).z);
    lowest = std::min(lowest, solid.grid.position(floor).z);
  }
  EXPECT_NEAR(highest, -0.8 * 3.5, 0.12);
  EXPECT_NEAR(lowest, -3.5, 0.01);
  EXPECT_NEAR(solid.grid.position(hollows[0].highest).z, 3.5, 0.01);
  EXPECT_NEAR(solid.grid.position(hollows[0].lowest).z, -3.5, 0.01);
}

TEST(Hollow, EndsAtALayerOfSamplesOfItsWall) {
  for (int axis = 0; axis < 3; ++axis) {
    Field solid = analytic::sampled(analytic::cube(9, 9.0), [&](const glm::dvec3& p) {
      const glm::dvec3 a = glm::abs(p);
      const bool isInside = std::max({a.x, a.y, a.z}) < 3.5;
      return isInside && std::abs(p[axis]) > 0.5 ? -2.0 * kWall : 0.5;
    });
    size_t filled = 0;
    EXPECT_EQ(hollowsOf(solid, kWall, 0.1, filled).size(), 2u) << axis;
    EXPECT_EQ(filled, 0u);
  }
}

TEST(Hollow, IsDeepEnoughForAHoleThatJustFits) {
  Field solid = analytic::sampled(
      analytic::cube(8, 8.0), [](const glm::dvec3& p) { return glm::length(p) < 2.0 ? -2.0 * kWall : 0.5; });
  size_t filled = 0;
  EXPECT_EQ(hollowsOf(solid, kWall, kWall, filled).size(), 1u);
  EXPECT_EQ(filled, 0u);
  EXPECT_EQ(hollowsOf(solid, kWall, std::nextafter(kWall, 1.0), filled).size(), 0u);
  EXPECT_EQ(filled, 1u);
}

TEST(Hollow, IsDrilledUpToTheBorderOfTheGrid) {
  const DrainHole hole{{0.1, 0.2, 0.3}, {0.1, 0.2, -6.0}, 1.2};
  constexpr int kCount = 32;
  const glm::dvec3 ways[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const DrainHole turned{hole.start, sign * 6.0 * ways[axis] + hole.start, hole.radius};
      Field solid = analytic::sampled(analytic::cube(kCount, 8.0), [](const glm::dvec3&) { return -9.0; });
      drill(solid, turned);
      size_t drilled = 0;
      for (int k = 0; k < kCount; ++k)
        for (int j = 0; j < kCount; ++j)
          for (int i = 0; i < kCount; ++i) {
            const glm::dvec3 p = solid.grid.position({i, j, k}) - turned.start;
            const double along = sign * p[axis];
            const bool isIn = along > 0.0 && glm::length(p - along * sign * ways[axis]) < turned.radius;
            EXPECT_EQ(solid.distance[solid.grid.index({i, j, k})] > 0.0f, isIn) << i << j << k;
            drilled += isIn ? 1 : 0;
          }
      EXPECT_GT(drilled, 500u);
    }
}

TEST(Hollow, IsFilledIfItIsTooShallow) {
  Field solid = solidTable();
  size_t filled = 0;
  EXPECT_EQ(hollowsOf(solid, kWall, 1.1, filled).size(), 0u);
  EXPECT_EQ(filled, 1u);
  EXPECT_TRUE(std::ranges::none_of(solid.distance, [](float d) { return d < -kWall; }));
}

/// Returns the samples of a solid that hollows and drain holes need.
Field bandOf(const Field& solid) {
  const double reach = kRadius / solid.grid.spacing, wall = kWall / solid.grid.spacing;
  return toSparse(solid, {.outside = reach + 1.0, .inside = wall + reach + 4.0});
}

/// A ball around a sealed cavity.
double cavernousBall(const glm::dvec3& p) {
  return std::max(analytic::sphere(p, 4.5), -analytic::sphere(p, 0.6));
}

/// Two balls, one higher.
double balls(const glm::dvec3& p) {
  return std::min(analytic::sphere(p - glm::dvec3(-2.4, 0, 0), 2.3),
                  analytic::sphere(p - glm::dvec3(2.4, 0, 0.5), 2.3));
}

TEST(Hollow, IsTheSameInANarrowBand) {
  struct Case {
    double (*distance)(const glm::dvec3&);
    double wall;
    size_t hollows;
    size_t tiles;
  };
  for (const Case& each : {Case{table, kWall, 1, 0}, Case{balls, kWall, 2, 1},
                           Case{cavernousBall, kWall, 1, 1}, Case{table, 0.9, 0, 0}}) {
    Field dense = analytic::sampled(analytic::cube(123, 10.0), each.distance), band = bandOf(dense);
    EXPECT_GE(band.narrow->tiles.size(), each.tiles);
    size_t filled = 0, filledInBand = 0;
    const std::vector<Hollow> expected = hollowsOf(dense, each.wall, kRadius, filled);
    const std::vector<Hollow> found = hollowsOf(band, each.wall, kRadius, filledInBand);
    EXPECT_EQ(filledInBand, filled);
    ASSERT_EQ(expected.size(), each.hollows);
    ASSERT_EQ(found.size(), each.hollows);
    std::vector<DrainHole> holes;
    for (size_t h = 0; h < found.size(); ++h) {
      EXPECT_EQ(std::isinf(found[h].deepest), each.tiles > 0);
      EXPECT_EQ(found[h].floors.size(), expected[h].floors.size());
      EXPECT_NEAR(found[h].lowest.z, expected[h].lowest.z, 0.01);
      EXPECT_NEAR(found[h].highest.z, expected[h].highest.z, 0.01);
      for (const DrainHole& hole : placeHoles(band, found[h], 3, kRadius, kDown)) {
        holes.push_back(hole);
        EXPECT_NEAR(glm::distance(exitOf(band, hole).position, exitOf(dense, hole).position), 0.0, 1e-6);
      }
    }
    EXPECT_GE(holes.size(), 2 * found.size());
    for (Field* solid : {&dense, &band}) {
      hollowOut(*solid, each.wall);
      for (const DrainHole& hole : holes) drill(*solid, hole);
    }
    validate(band);
    size_t differing = 0, inside = 0;
    for (size_t i = 0; i < dense.distance.size(); ++i) {
      const glm::ivec3 sample(i % 123, i / 123 % 123, i / (123 * 123));
      differing += (dense.distance[i] < 0.0f) == (band.distanceAt(sample) < 0.0f) ? 0 : 1;
      inside += dense.distance[i] < 0.0f ? 1 : 0;
    }
    EXPECT_EQ(differing, 0u);
    EXPECT_GT(inside, 10000u);
  }
}

/// A box along the diagonal of a cube.
Mesh obliqueBox(double length, double width) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1.0)), u = glm::normalize(glm::dvec3(1, -1, 0));
  const glm::dmat3 turn(u, glm::cross(axis, u), axis);
  const Mesh box = shapes::box({0, 0, 0}, {width, width, length});
  std::vector<glm::dvec3> points;
  for (uint32_t v = 0; v < box.vertices.size(); ++v) points.push_back(turn * box.position(v));
  return makeMesh(points, box.triangles);
}

TEST(Hollow, IsMadeWhereNoDenseFieldFits) {
  constexpr double kLength = 3000.0, kWidth = 16.0, kThin = 4.0;
  const Mesh mesh = obliqueBox(kLength, kWidth);
  const Grid grid = fitGrid(mesh, {.voxelSize = 1.0});
  EXPECT_GE(4 * grid.sampleCount(), size_t{32} << 30);
  RepairOptions options{
      .shell = kThin, .drainHole = 4.0, .drainHoles = 2, .tolerance = 0.0, .measure = false};
  const Repaired made = repair(mesh, grid, {}, options);
  EXPECT_EQ(made.report.hollows, 1u);
  EXPECT_EQ(made.report.filledHollows, 0u);
  EXPECT_EQ(made.report.solids, 1u);
  EXPECT_EQ(made.report.cavities, 0u);
  ASSERT_EQ(made.report.drainHoles, 2u);
  const Diagnostics found = diagnose(made.mesh);
  EXPECT_TRUE(found.watertight);
  const double inner = kWidth - 2.0 * kThin;
  const double volume = kWidth * kWidth * kLength - inner * inner * (kLength - 2.0 * kThin);
  EXPECT_NEAR(found.signedVolume, volume, 0.01 * volume);
  // Its lowest corner is at (0, 0, 0), its highest at the other end.
  EXPECT_LT(glm::length(made.report.drainHolePlaces[0].position), 3.0 * kWidth);
  EXPECT_NEAR(glm::length(made.report.drainHolePlaces[1].position), kLength, 3.0 * kWidth);

  options.drainHole = 10.0;  // The hollow is 8 wide.
  const Repaired solid = repair(mesh, grid, {}, options);
  EXPECT_EQ(solid.report.hollows, 0u);
  EXPECT_EQ(solid.report.filledHollows, 1u);
  EXPECT_NEAR(diagnose(solid.mesh).signedVolume, kWidth * kWidth * kLength, 0.01 * volume);
}

TEST(Hollow, IsLeftInAllNestedSolids) {
  using shapes::inverted;
  const Mesh mesh = shapes::joined(shapes::joined(shapes::sphere(10.0, 4), inverted(shapes::sphere(6.0, 4))),
                                   shapes::sphere(4.0, 4));
  const Grid grid = fitGrid(mesh, {.voxelSize = 0.25});
  const RepairOptions options{.shell = 1.0, .keepCavities = true, .measure = false};
  const Repaired band = repair(mesh, grid, {}, options);
  const Repaired dense = repair(mesh, grid, {.sign = SignMode::Exact}, options);
  for (const Repaired* made : {&band, &dense}) {
    EXPECT_EQ(made->report.hollows, 2u);
    EXPECT_EQ(made->report.solids, 3u);
    EXPECT_EQ(made->report.cavities, 3u);
    const double cubes = 1000 - 9 * 81 + 7 * 49 - 216 + 64 - 27;
    EXPECT_NEAR(diagnose(made->mesh).signedVolume, 4.18879 * cubes, 0.01 * 4.18879 * cubes);
  }
}

}  // namespace
}  // namespace raymap
