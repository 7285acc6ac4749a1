#include "repair/solid/hollow.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "analytic_fields.h"

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

}  // namespace
}  // namespace raymap
