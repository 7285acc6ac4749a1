#include "predicates/triangle_triangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace raymap {
namespace {

bool areCrossing(const WholeTriangle& a, const WholeTriangle& b, bool areSmall = true) {
  return meet(a, WholePlane(a), b, areSmall) == Meeting::Cross;
}

constexpr WholeTriangle kFlat{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};

TEST(TriangleTriangle, CrossWhereInnerPointsCoincide) {
  EXPECT_TRUE(areCrossing(kFlat, {{{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}}));
  EXPECT_TRUE(areCrossing(kFlat, {{{1, -5, -1}, {1, 5, -1}, {1, 0, 9}}}));
  EXPECT_FALSE(areCrossing(kFlat, {{{5, 5, -1}, {5, 5, 1}, {9, 9, 1}}}));
  EXPECT_FALSE(areCrossing(kFlat, {{{1, 1, 1}, {2, 1, 1}, {1, 2, 3}}}));
}

TEST(TriangleTriangle, DoNotCrossWhereTheyTouch) {
  EXPECT_FALSE(areCrossing(kFlat, {{{0, 0, 0}, {4, 0, 0}, {0, 0, 4}}})) << "a common edge";
  EXPECT_FALSE(areCrossing(kFlat, {{{0, 0, 0}, {-4, 0, 1}, {0, -4, -1}}})) << "a common corner";
  EXPECT_FALSE(areCrossing(kFlat, {{{1, 1, 0}, {1, 1, 4}, {2, 1, 4}}})) << "a corner in the other's inside";
  EXPECT_FALSE(areCrossing(kFlat, {{{1, 1, 0}, {5, 1, 0}, {1, 5, 0}}})) << "a common plane";
  EXPECT_FALSE(areCrossing(kFlat, kFlat));
}

bool areInPlane(const WholeTriangle& a, const WholeTriangle& b) {
  const bool one = meet(a, WholePlane(a), b, true) == Meeting::InPlane;
  EXPECT_EQ(meet(b, WholePlane(b), a, false) == Meeting::InPlane, one);
  return one;
}

TEST(TriangleTriangle, OverlapInAPlaneWhereInnerPointsCoincide) {
  // Along every axis, and in planes across several.
  for (const glm::ivec3& lift : {glm::ivec3(0), glm::ivec3(1, 0, 0), glm::ivec3(2, 3, 0)})
    for (int axis = 0; axis < 3; ++axis) {
      const auto placed = [&](const WholeTriangle& t) {
        WholeTriangle result;
        for (size_t c = 0; c < 3; ++c) {
          const int u = t[c].x, v = t[c].y;
          result[c][axis] = u, result[c][(axis + 1) % 3] = v;
          result[c][(axis + 2) % 3] = u * lift.x + v * lift.y;
        }
        return result;
      };
      const WholeTriangle flat = placed(kFlat);
      const auto overlaps = [&](const WholeTriangle& t) { return areInPlane(flat, placed(t)); };
      EXPECT_TRUE(overlaps({{{1, 1, 0}, {5, 1, 0}, {1, 5, 0}}}));
      EXPECT_TRUE(overlaps({{{1, 1, 0}, {1, 5, 0}, {5, 1, 0}}})) << "the other winding order";
      EXPECT_TRUE(overlaps({{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}})) << "inside";
      EXPECT_TRUE(overlaps({{{-9, -9, 0}, {30, -9, 0}, {-9, 30, 0}}})) << "around";
      EXPECT_TRUE(overlaps({{{-1, 1, 0}, {9, 1, 0}, {9, 2, 0}}})) << "no corner of one is in the other";
      EXPECT_TRUE(overlaps(kFlat));
      EXPECT_FALSE(overlaps({{{4, 0, 0}, {4, 4, 0}, {0, 4, 0}}})) << "a common edge";
      EXPECT_FALSE(overlaps({{{4, 0, 0}, {0, 4, 0}, {4, 4, 0}}})) << "a common edge, the other winding order";
      EXPECT_FALSE(overlaps({{{-2, 0, 0}, {6, 0, 0}, {0, -4, 0}}})) << "a part of an edge";
      EXPECT_FALSE(overlaps({{{0, 0, 0}, {-4, 0, 0}, {0, -4, 0}}})) << "a common corner";
      EXPECT_FALSE(overlaps({{{5, 5, 0}, {9, 5, 0}, {5, 9, 0}}})) << "apart";
      EXPECT_FALSE(overlaps({{{1, 1, 0}, {2, 1, 0}, {3, 1, 0}}})) << "no area";
      EXPECT_FALSE(overlaps({{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}})) << "a point";
    }
  EXPECT_FALSE(areInPlane(kFlat, {{{1, 1, 1}, {5, 1, 1}, {1, 5, 1}}})) << "a parallel plane";
  EXPECT_FALSE(areInPlane(kFlat, {{{1, 1, 0}, {5, 1, 0}, {1, 5, 1}}})) << "another plane";
}

TEST(TriangleTriangle, OverlapInAPlaneAtTheLargestCoordinates) {
  constexpr int kMost = 1 << kTriangleBits;
  const WholeTriangle large{{{-kMost, -kMost, kMost}, {kMost, -kMost, kMost}, {-kMost, kMost, kMost}}};
  const WholeTriangle other{{{kMost, kMost, kMost}, {-kMost, kMost, kMost}, {kMost, -kMost, kMost}}};
  EXPECT_EQ(meet(large, WholePlane(large), other, false), Meeting::None);
  WholeTriangle moved = other;
  moved[1].y -= 1;
  EXPECT_EQ(meet(large, WholePlane(large), moved, false), Meeting::InPlane);
}

TEST(TriangleTriangle, CrossEachOtherWhateverTheOrderOfCornersAndThePrecision) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> whole(-4, 4);
  const auto triangle = [&] {
    WholeTriangle t;
    for (glm::ivec3& p : t) p = {whole(random), whole(random), whole(random)};
    return t;
  };
  const auto turned = [](const WholeTriangle& t) { return WholeTriangle{t[1], t[2], t[0]}; };
  const auto reversed = [](const WholeTriangle& t) { return WholeTriangle{t[0], t[2], t[1]}; };
  const auto scaled = [](WholeTriangle t) {
    for (glm::ivec3& p : t) p *= 1 << (kTriangleBits - 2);
    return t;
  };
  size_t crossing = 0;
  for (int i = 0; i < 20000; ++i) {
    const WholeTriangle a = triangle(), b = triangle();
    const bool isCrossing = areCrossing(a, b);
    crossing += isCrossing ? 1 : 0;
    ASSERT_EQ(areCrossing(b, a), isCrossing);
    ASSERT_EQ(areCrossing(turned(a), reversed(b)), isCrossing);
    ASSERT_EQ(areCrossing(reversed(a), turned(b)), isCrossing);
    ASSERT_EQ(areCrossing(a, b, false), isCrossing);
    ASSERT_EQ(areCrossing(scaled(a), scaled(b), false), isCrossing);
  }
  EXPECT_GT(crossing, 1000u);
}

/// Returns whether the edge between corners `k` and `k` + 1 of a triangle has a point of the other triangle.
bool passesThrough(const WholeTriangle& a, size_t k, const WholeTriangle& b) {
  const glm::dvec3 from(a[k]), to(a[(k + 1) % 3]), normal(WholePlane(b).normal());  // All numbers are whole.
  const auto height = [&](const glm::dvec3& p) { return glm::dot(normal, p - glm::dvec3(b[0])); };
  const double h = height(from), whole = h - height(to);
  if (whole == 0.0 || h * whole < 0.0 || std::abs(h) > std::abs(whole)) return false;
  const glm::dvec3 scaled = whole * from + h * (to - from);  // The point in the plane, times `whole`.
  for (size_t e = 0; e < 3; ++e) {
    const glm::dvec3 corner(b[e]), edge = glm::dvec3(b[(e + 1) % 3]) - corner;
    if (glm::dot(normal, glm::cross(edge, scaled - whole * corner)) * whole < 0.0) return false;
  }
  return true;
}

TEST(TriangleTriangle, MayTouchOutsideOfACommonCornerOnlyWhereTheyDo) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> whole(-4, 4);
  size_t touching = 0, apart = 0;
  for (int i = 0; i < 100000; ++i) {
    WholeTriangle a, b;
    for (size_t k = 0; k < 3; ++k) {
      a[k] = {whole(random), whole(random), whole(random)};
      b[k] = {whole(random), whole(random), whole(random)};
    }
    const auto at = size_t(whole(random) + 4) % 3, other = size_t(whole(random) + 4) % 3;
    b[other] = a[at];
    const WholePlane plane(a);
    const CornerSides ofA = WholePlane(b).sidesOf(a, true), ofB = plane.sidesOf(b, true);
    if (!areOnBoth(ofA) || !areOnBoth(ofB)) continue;
    const bool areTouching = passesThrough(a, (at + 1) % 3, b) || passesThrough(b, (other + 1) % 3, a);
    ASSERT_EQ(mayTouch(a, plane, b, true) == Meeting::Cross, areTouching);
    ++(areTouching ? touching : apart);
  }
  EXPECT_GT(touching, 500u);
  EXPECT_GT(apart, 500u);
}

}  // namespace
}  // namespace raymap
