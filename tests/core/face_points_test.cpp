#include "mesh/face_points.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace raymap {
namespace {

using glm::dvec3;
using glm::vec3;

const vec3 kA(0, 0, 1), kB(5, 1, 1), kC(1, 3, 2);

/// Returns the least of a point's weights in a triangle, of which none is negative inside.
double leastWeight(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 n = doubleAreaNormal(a, b, c);
  const auto weight = [&](const dvec3& s, const dvec3& e) {
    return glm::dot(doubleAreaNormal(p, s, e), n) / glm::dot(n, n);
  };
  return std::min({weight(a, b), weight(b, c), weight(c, a)});
}

/// Returns the largest distance from points of a triangle to the closest of `points`.
double widestGap(const std::vector<dvec3>& points, const dvec3& a, const dvec3& b, const dvec3& c) {
  double widest = 0.0;
  constexpr int kParts = 40;
  for (int i = 0; i <= kParts; ++i)
    for (int j = 0; i + j <= kParts; ++j) {
      const dvec3 p = a + (double(i) * (b - a) + double(j) * (c - a)) / double(kParts);
      double least = INFINITY;
      for (const dvec3& q : points) least = std::min(least, glm::distance(p, q));
      widest = std::max(widest, least);
    }
  return widest;
}

TEST(FacePoints, LengthsAreCutIntoParts) {
  EXPECT_EQ(partsOf(0.0, 1.0), 1);
  EXPECT_EQ(partsOf(2.0, 1.0), 2);
  EXPECT_EQ(partsOf(2.1, 1.0), 3);
  EXPECT_EQ(partsOf(1e9, 1.0), 1'000'000);
}

TEST(FacePoints, EdgesHaveTheMiddlesOfTheirParts) {
  std::vector<dvec3> points;
  forEachEdgePoint({0, 0, 0}, {4, 0, 0}, 2, [&](const dvec3& p) { points.push_back(p); });
  EXPECT_EQ(points, (std::vector<dvec3>{{1, 0, 0}, {3, 0, 0}}));
}

/// Cuts a triangle, and expects parts that cover it, wind alike and have no long sides. Returns their number.
size_t countParts(const vec3& a, const vec3& b, const vec3& c, double step) {
  dvec3 sum(0.0);
  size_t parts = 0;
  const dvec3 whole = doubleAreaNormal(a, b, c);
  forEachFacePart(a, b, c, step, [&](const vec3& d, const vec3& e, const vec3& f) {
    EXPECT_LE(longestSide(d, e, f), step * (1.0 + 1e-5));
    const dvec3 part = doubleAreaNormal(d, e, f);
    EXPECT_GE(glm::dot(part, whole), 0.0);
    sum += part;
    ++parts;
  });
  EXPECT_NEAR(glm::distance(sum, whole), 0.0, 1e-5);
  return parts;
}

TEST(FacePoints, PartsAreTrianglesThatWindAlike) {
  for (const double step : {10.0, 2.0, 0.3}) EXPECT_EQ(countParts(kA, kB, kC, step) == 1, step == 10.0);
}

TEST(FacePoints, PartsOfSliversAreAsManyAsTheyAreLong) {
  for (const float along : {0.0f, 0.3f, 20.0f, 64.0f})
    for (const float height : {0.01f, 0.45f}) {
      const vec3 a(0, 0, 0), b(64, 0, 0), c(along, height, 0);
      for (const size_t parts :
           {countParts(a, b, c, 1.0), countParts(b, c, a, 1.0), countParts(c, a, b, 1.0)}) {
        EXPECT_GE(parts, 64u);
        EXPECT_LE(parts, 2u * 75u);
      }
    }
  // Twice as long: twice as many parts.
  EXPECT_LE(countParts({0, 0, 0}, {4096, 0, 0}, {4096, 0.01f, 0}, 1.0), 2u * 4100u);
}

/// Squares of such lengths are infinite or 0 in single precision.
TEST(FacePoints, PartsAreTheSameInAnyUnit) {
  using Parts = std::vector<std::array<vec3, 3>>;
  const auto partsOf = [](float unit) {
    Parts parts;
    forEachFacePart(unit * kA, unit * kB, unit * kC, 0.7 * double(unit),
                    [&](const vec3& d, const vec3& e, const vec3& f) {
                      parts.push_back({d / unit, e / unit, f / unit});
                    });
    return parts;
  };
  const Parts parts = partsOf(1.0f);
  EXPECT_EQ(parts.size(), 96u);
  EXPECT_EQ(partsOf(0x1p100f), parts);
  EXPECT_EQ(partsOf(0x1p-100f), parts);
}

TEST(FacePoints, PartsAreAtMostAsManyAsHalvingsAllow) {
  size_t parts = 0;
  const auto count = [&](const vec3&, const vec3&, const vec3&) { ++parts; };
  forEachFacePart({0, 0, 0}, {64, 0, 0}, {20, 0.0f, 0}, 0.001, count, 4);
  EXPECT_LE(parts, 16u);
  EXPECT_GE(parts, 12u);
  parts = 0;
  forEachFacePart(
      {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.0, [&](const vec3&, const vec3&, const vec3&) { ++parts; }, 4);
  EXPECT_EQ(parts, 16u);
}

TEST(FacePoints, RowsLeaveNoGapMuchWiderThanAStep) {
  for (const double step : {1.5, 0.5, 0.2})
    for (const auto& [a, b, c] : {std::array<dvec3, 3>{kA, kB, kC}, {kC, kA, kB}, {kB, kC, kA}}) {
      std::vector<dvec3> points;
      forEachFacePoint(a, b, c, step, [&](const dvec3& p) { points.push_back(p); });
      for (const dvec3& p : points) EXPECT_GT(leastWeight(p, a, b, c), -1e-12);
      EXPECT_LT(widestGap(points, a, b, c), 1.2 * step);
      const double squares = triangleArea(a, b, c) / (step * step);
      EXPECT_GE(double(points.size()), squares);
      EXPECT_LT(double(points.size()), squares + 4.0 * longestSide(a, b, c) / step);
    }
}

TEST(FacePoints, RowsOfATriangleWithoutAreaAreOneRow) {
  std::vector<dvec3> points;
  forEachFacePoint({0, 0, 0}, {1, 0, 0}, {4, 0, 0}, 1.0, [&](const dvec3& p) { points.push_back(p); });
  EXPECT_EQ(points.size(), 2u);
  points.clear();
  forEachFacePoint({1, 2, 3}, {1, 2, 3}, {1, 2, 3}, 1.0, [&](const dvec3& p) { points.push_back(p); });
  EXPECT_EQ(points, std::vector<dvec3>{dvec3(1, 2, 3)});
}

}  // namespace
}  // namespace raymap
