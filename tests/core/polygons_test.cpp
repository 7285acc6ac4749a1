#include "mesh/polygons.h"

#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/polygons.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include "mesh/edge_flips.h"
#include "mesh/polygon.h"

namespace raymap {
namespace {

using Corners = std::vector<glm::dvec3>;

Corners flat(std::initializer_list<glm::dvec2> points) {
  Corners corners;
  for (const glm::dvec2& p : points) corners.emplace_back(p, 0.0);
  return corners;
}

Corners turnedRound(Corners corners, size_t first) {
  std::rotate(corners.begin(), corners.begin() + static_cast<ptrdiff_t>(first), corners.end());
  return corners;
}

Corners reversed(Corners corners) {
  std::ranges::reverse(corners);
  return corners;
}

/// Returns the corners moved in space, as `Real` rounds them.
template <class Real>
Corners tilted(const Corners& corners, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto vector = [&] { return glm::dvec3(any(random), any(random), any(random)); };
  const glm::dvec3 u = glm::normalize(vector()), w = glm::normalize(glm::cross(u, vector())),
                   v = glm::cross(w, u), origin = 5.0 * vector();
  Corners moved;
  for (const glm::dvec3& p : corners)
    moved.emplace_back(glm::vec<3, Real>(origin + p.x * u + p.y * v + p.z * w));
  return moved;
}

/// Returns the area of a polygon's area vector.
double areaOf(const Corners& corners) {
  glm::dvec3 sum(0.0);
  for (size_t c = 2; c < corners.size(); ++c)
    sum += glm::cross(corners[c - 1] - corners[0], corners[c] - corners[0]);
  return 0.5 * glm::length(sum);
}

struct Cutting {
  PolygonCut cut = PolygonCut::None;
  std::vector<glm::uvec3> triangles;
  double area = 0.0;       ///< Sum of the triangles' areas.
  double smallest = 0.0;   ///< Smallest of them; negative for a triangle that is turned over.
  bool keepsEdges = true;  ///< Whether the polygon's edges, and no others, have one triangle.
};

Cutting cutOf(const Corners& corners) {
  Cutting result;
  result.cut = cutPolygon(corners, result.triangles);
  glm::dvec3 normal(0.0);
  for (size_t c = 2; c < corners.size(); ++c)
    normal += glm::cross(corners[c - 1] - corners[0], corners[c] - corners[0]);
  normal = glm::normalize(normal);
  result.smallest = INFINITY;
  std::map<std::array<double, 6>, int> edges;
  const auto add = [&](const glm::dvec3& a, const glm::dvec3& b, int count) {
    if (a == b) return;
    edges[{a.x, a.y, a.z, b.x, b.y, b.z}] += count;
    edges[{b.x, b.y, b.z, a.x, a.y, a.z}] -= count;
  };
  for (const glm::uvec3& t : result.triangles) {
    const double area =
        0.5 * glm::dot(glm::cross(corners[t.y] - corners[t.x], corners[t.z] - corners[t.x]), normal);
    result.area += std::abs(area);
    result.smallest = std::min(result.smallest, area);
    for (int c = 0; c < 3; ++c) add(corners[t[c]], corners[t[(c + 1) % 3]], 1);
  }
  for (size_t c = 0; c < corners.size(); ++c) add(corners[c], corners[(c + 1) % corners.size()], -1);
  for (const auto& [edge, count] : edges) result.keepsEdges = result.keepsEdges && count == 0;
  return result;
}

/// Expects triangles that cover the polygon, whichever corner comes first and whichever way it turns.
void expectCovered(const Corners& given, size_t triangles, double area, double smallest = 1e-12,
                   double rounding = 1e-12) {
  ASSERT_NEAR(areaOf(given), area, rounding * area);
  const size_t step = 1 + given.size() / 50;
  for (const Corners& corners : {given, reversed(given)})
    for (size_t first = 0; first < corners.size(); first += step) {
      const Cutting cutting = cutOf(turnedRound(corners, first));
      SCOPED_TRACE("first corner " + std::to_string(first));
      EXPECT_NE(cutting.cut, PolygonCut::None);
      EXPECT_EQ(cutting.triangles.size(), triangles);
      EXPECT_NEAR(cutting.area, area, rounding * area);
      EXPECT_GE(cutting.smallest, smallest);
      EXPECT_TRUE(cutting.keepsEdges);
    }
}

/// Expects a fan around the first corner.
void expectFan(const Corners& corners, PolygonCut cut) {
  const Cutting cutting = cutOf(corners);
  EXPECT_EQ(cutting.cut, cut);
  ASSERT_EQ(cutting.triangles.size(), corners.size() - 2);
  for (uint32_t t = 0; t < cutting.triangles.size(); ++t)
    EXPECT_EQ(cutting.triangles[t], glm::uvec3(0, t + 1, t + 2));
}

const Corners kU = flat({{0, 0}, {30, 0}, {30, 30}, {20, 30}, {20, 10}, {10, 10}, {10, 30}, {0, 30}});
const Corners kSquareWithHole =
    flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}});
/// A notch reaches the opposite edge, between its ends.
const Corners kTouching = flat({{0, 0}, {4, 0}, {4, 4}, {3, 4}, {2, 0}, {1, 4}, {0, 4}});

Corners ring(size_t corners, double inner, size_t run) {
  Corners result;
  for (size_t i = 0; i < corners; ++i) {
    const double angle = 2.0 * M_PI * double(i) / double(corners);
    const double radius = i / run % 2 ? inner : 1.0;
    result.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  return result;
}

Corners comb(size_t teeth) {
  Corners result = flat({{-1, 0}, {double(2 * teeth), 0}});
  for (size_t t = teeth; t-- > 0;)
    for (const glm::dvec2& p : {glm::dvec2(1, 1), glm::dvec2(1, 50), glm::dvec2(0, 50), glm::dvec2(0, 1)})
      result.emplace_back(p + glm::dvec2(2.0 * double(t), 0.0), 0.0);
  return result;
}

Corners spiral(size_t half) {
  Corners result;
  const auto add = [&](size_t i, double more) {
    const double angle = 0.05 * double(i), radius = 1.0 + angle + more;
    result.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  };
  for (size_t i = 0; i < half; ++i) add(i, 1.5);
  for (size_t i = half; i-- > 0;) add(i, 0.0);
  return result;
}

TEST(CutPolygon, KeepsFansOfConvexPolygons) {
  for (size_t n : {3u, 4u, 5u, 50u, 3000u})
    for (uint32_t seed = 0; seed < 3; ++seed) {
      expectFan(tilted<double>(ring(n, 1.0, 1), seed), PolygonCut::Fan);
      expectFan(tilted<float>(reversed(ring(n, 1.0, 1)), seed), PolygonCut::Fan);
    }
  expectFan(flat({{0, 0}, {1, 0}, {1, 0}, {1, 1}}), PolygonCut::Fan);
  expectFan(flat({{0, 0}, {0, 0}, {1, 0}, {1, 1}}), PolygonCut::Fan);
  expectFan(flat({{0, 0}, {1, 0}, {1, 1}, {0, 0}}), PolygonCut::Fan);
  expectFan(flat({{0, 0}, {0, 0}, {1, 0}, {1, 0}, {1, 1}, {1, 1}, {0, 0}}), PolygonCut::Fan);
  expectFan({{0, 0, 0}, {1, 0, 0.3}, {1, 1, 0}, {0, 1, 0.3}}, PolygonCut::Fan);
  expectFan(flat({{0, 0}, {1, 0}, {1, 1e-7}, {0, 1e-7}}), PolygonCut::Fan);  // A needle.
}

TEST(CutPolygon, KeepsFansThatCoverTheRest) {
  const Corners corner = flat({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  expectFan(corner, PolygonCut::Fan);
  expectFan(turnedRound(corner, 3), PolygonCut::Fan);
  EXPECT_EQ(cutOf(turnedRound(corner, 1)).cut, PolygonCut::Swept);
  expectCovered(corner, 4, 3.0);
}

TEST(CutPolygon, CoversConcavePolygons) {
  expectCovered(kU, 6, 700.0);
  expectCovered(ring(40, 0.9, 2), 38, areaOf(ring(40, 0.9, 2)));
  expectCovered(ring(200, 0.1, 1), 198, areaOf(ring(200, 0.1, 1)), 1e-7);
  expectCovered(spiral(100), 198, areaOf(spiral(100)), 1e-9);
  expectCovered(comb(20), 80, 1020.0);
}

TEST(CutPolygon, CoversPolygonsInSpace) {
  for (uint32_t seed = 0; seed < 20; ++seed) {
    expectCovered(tilted<double>(kU, seed), 6, 700.0, 1e-9, 1e-12);
    expectCovered(tilted<float>(kU, seed), 6, areaOf(tilted<float>(kU, seed)), 1e-3, 1e-5);
    const Corners star = tilted<float>(ring(200, 0.1, 1), seed);
    expectCovered(star, 198, areaOf(star), 1e-7, 1e-5);
  }
  // Each plane of two axes, from both sides.
  for (const Corners& corners : {kU, reversed(kU)}) {
    Corners yz, zx;
    for (const glm::dvec3& p : corners) {
      yz.emplace_back(5.0, p.x, p.y);
      zx.emplace_back(p.y, 5.0, p.x);
    }
    expectCovered(yz, 6, 700.0);
    expectCovered(zx, 6, 700.0);
  }
}

TEST(CutPolygon, ProjectsWhatIsNotFlat) {
  // In each plane of two axes the corners off the plane would cross an edge.
  Corners bent = tilted<double>(kU, 3);
  const glm::dvec3 normal = glm::normalize(glm::cross(bent[1] - bent[0], bent[2] - bent[0]));
  for (size_t c = 0; c < bent.size(); ++c) bent[c] += (c % 2 == 0 ? 9.0 : -9.0) * normal;
  for (size_t first = 0; first < bent.size(); ++first) {
    const Cutting cutting = cutOf(turnedRound(bent, first));
    EXPECT_NE(cutting.cut, PolygonCut::None);
    EXPECT_EQ(cutting.triangles.size(), 6u);
    EXPECT_GT(cutting.smallest, 40.0);
    EXPECT_TRUE(cutting.keepsEdges);
  }
}

TEST(CutPolygon, UsesCornersWithinEdges) {
  // A fan around the first corner would have a triangle without area.
  const Corners square = flat({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}});
  expectCovered(square, 6, 4.0, 0.1);
  for (uint32_t seed = 0; seed < 20; ++seed) {
    const Corners rounded = tilted<float>(square, seed);
    expectCovered(rounded, 6, areaOf(rounded), 0.1, 1e-5);
  }
  expectCovered(flat({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1.5}, {0, 1}}), 7, 3.0);
  Corners walls;  // Every unit of the U's edges.
  for (size_t c = 0; c < kU.size(); ++c)
    for (int i = 0; i < 10; ++i) walls.push_back(glm::mix(kU[c], kU[(c + 1) % kU.size()], 0.1 * i));
  expectCovered(walls, 78, 700.0, 0.5);
  for (uint32_t seed = 0; seed < 3; ++seed) {
    const Corners rounded = tilted<float>(walls, seed);
    expectCovered(rounded, 78, areaOf(rounded), 0.5, 1e-5);
  }
}

TEST(CutPolygon, CoversWhatTouchesItself) {
  expectCovered(kSquareWithHole, 8, 12.0);
  expectCovered(flat({{0, 0},
                      {9, 0},
                      {9, 4},
                      {0, 4},
                      {0, 0},
                      {1, 1},
                      {1, 3},
                      {3, 3},
                      {3, 1},
                      {5, 1},
                      {5, 3},
                      {7, 3},
                      {7, 1},
                      {5, 1},
                      {3, 1},
                      {1, 1}}),
                14, 28.0);
  // Two triangles that share a corner, and a spike.
  expectCovered(flat({{0, 0}, {1, 1}, {2, 0}, {2, 2}, {1, 1}, {0, 2}}), 2, 2.0);
  expectCovered(
      flat({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1.5, 1}, {1.5, 2}, {1.5, 1}, {1, 1}, {1, 3}, {0, 3}}), 7,
      7.0);
  // Corners that repeat.
  expectCovered(flat({{0, 0}, {0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}), 6,
                7.0);
}

TEST(CutPolygon, SplitsEdgesThatCornersTouch) {
  // The whole edge stays: one triangle without area has it, and the corner on it.
  expectCovered(kTouching, 5, 12.0, 0.0);
  expectCovered(
      flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 2}, {1, 2}, {1, 3}, {3, 3}, {3, 1}, {0, 2}, {0, 1.5}}), 9,
      12.5, 0.0);
  // A bridge with a corner on one of its sides.
  expectCovered(
      flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {0.5, 0.5}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}), 9,
      12.0, 0.0);
}

TEST(CutPolygon, TakesRoundingForTouching) {
  for (const Corners& shape : {kSquareWithHole, kTouching})
    for (uint32_t seed = 0; seed < 60; ++seed) {
      const Corners corners = turnedRound(tilted<float>(shape, seed), seed % shape.size());
      const Cutting cutting = cutOf(corners);
      EXPECT_NEAR(cutting.area, 12.0, 1e-4) << seed;
      EXPECT_TRUE(cutting.keepsEdges);
      EXPECT_NE(cutting.cut, PolygonCut::None) << seed;
    }
  // Beyond the edge by less than the noise, and by more.
  Corners beyond = kTouching;
  beyond[4].y = -3e-6;
  EXPECT_EQ(cutOf(beyond).cut, PolygonCut::Swept);
  beyond[4].y = -5e-6;
  EXPECT_EQ(cutOf(beyond).cut, PolygonCut::None);
}

TEST(CutPolygon, LeavesFansOfWhatHasNoTriangles) {
  expectFan(flat({{0, 0}, {2, 2}, {2, 0}, {0, 3}}), PolygonCut::None);
  expectFan(flat({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), PolygonCut::None);
  expectFan(flat({{0, 0}, {4, 0}, {4, 4}, {2, -1}, {0, 4}}), PolygonCut::None);
  expectFan(flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {1.5, 0}}), PolygonCut::None);
  expectFan(flat({{1, 1}, {1, 1}, {1, 1}, {1, 1}}), PolygonCut::None);
  expectFan(flat({{0, 0}, {0, 0}, {1, 1}, {1, 1}}), PolygonCut::None);
  expectFan(ring(5, 1.0, 1), PolygonCut::Fan);
  const Corners five = ring(5, 1.0, 1);
  expectFan({five[0], five[2], five[4], five[1], five[3]}, PolygonCut::None);
  // Twice around.
  expectFan(flat({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}}), PolygonCut::None);
  expectFan(flat({{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {2, 0}, {0, 2}, {-2, 0}, {0, -2}}), PolygonCut::None);
  // The hole turns the way that the outside does.
  expectFan(flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {3, 1}, {3, 3}, {1, 3}, {1, 1}}),
            PolygonCut::None);
}

TEST(CutPolygon, WorksAtAnySize) {
  for (const double size : {1e-290, 1e-30, 1e12, 1e37, 1e200}) {
    Corners scaled = kU;
    for (glm::dvec3& p : scaled) p *= size;
    for (size_t first = 0; first < scaled.size(); ++first) {
      std::vector<glm::uvec3> triangles;
      EXPECT_NE(cutPolygon(turnedRound(scaled, first), triangles), PolygonCut::None);
      double area = 0.0;
      for (const glm::uvec3& t : triangles) {
        const Corners round = turnedRound(kU, first);
        area += areaOf({round[t.x], round[t.y], round[t.z]});
      }
      EXPECT_DOUBLE_EQ(area, 700.0) << size;
    }
  }
  Corners far = kU;
  for (glm::dvec3& p : far) p += glm::dvec3(1e9, -1e9, 1e9);
  expectCovered(far, 6, 700.0);
}

TEST(CutPolygon, LeavesWhatIsNotFinite) {
  for (const double value : {double(NAN), double(INFINITY)}) {
    Corners corners = turnedRound(kU, 1);
    corners[3].y = value;
    expectFan(corners, PolygonCut::Fan);
  }
  expectFan(flat({{-1e308, -1e308}, {1e308, 0}, {0, 0}, {0, 1e308}}), PolygonCut::Fan);
}

TEST(CutPolygon, CoversThousandsOfCorners) {
  const size_t n = 10000;
  for (const Corners& corners : {ring(n, 0.9, 2), comb(n / 4), spiral(n / 2)}) {
    const Cutting cutting = cutOf(turnedRound(corners, 1));
    EXPECT_EQ(cutting.cut, PolygonCut::Swept);
    EXPECT_EQ(cutting.triangles.size(), corners.size() - 2);
    EXPECT_NEAR(cutting.area, areaOf(corners), 1e-9 * cutting.area);
    EXPECT_GT(cutting.smallest, 0.0);
    EXPECT_TRUE(cutting.keepsEdges);
  }
}

TEST(CutPolygon, EndsWhereManyEdgesCoverEachOther) {
  std::mt19937 random(1);
  Corners corners = flat({{0, 1}});
  for (int i = 0; i < 2000; ++i) corners.emplace_back(double(random() % 100000), 0.0, 0.0);
  EXPECT_EQ(cutOf(corners).triangles.size(), 2000u - 1);
}

TEST(FlipThinTriangles, FlipsWhatIsInACircle) {
  const std::vector<glm::dvec2> rhombus{{0, 0}, {10, 0}, {5, 1}, {5, -1}};
  std::vector<glm::uvec3> triangles{{0, 1, 2}, {1, 0, 3}};
  flipThinTriangles(rhombus, triangles);
  EXPECT_EQ(triangles, (std::vector<glm::uvec3>{{2, 0, 3}, {1, 2, 3}}));
  flipThinTriangles(rhombus, triangles);
  EXPECT_EQ(triangles, (std::vector<glm::uvec3>{{2, 0, 3}, {1, 2, 3}}));
}

TEST(FlipThinTriangles, LeavesTheRest) {
  const std::vector<glm::uvec3> both{{0, 1, 2}, {1, 0, 3}};
  for (const std::vector<glm::dvec2>& corners :
       {std::vector<glm::dvec2>{{0, 0}, {2, 2}, {0, 2}, {2, 0}},  // All on a circle.
        std::vector<glm::dvec2>{
            {0, 0}, {10, 0}, {0.1, 1}, {-9, -1}},  // Not convex, at one end and the other.
        std::vector<glm::dvec2>{{10, 0}, {0, 0}, {-9, -1}, {0.1, 1}},
        std::vector<glm::dvec2>{{0, 0}, {10, 0}, {0, 1}, {0, -1}}}) {  // Three on a line.
    std::vector<glm::uvec3> triangles = both;
    flipThinTriangles(corners, triangles);
    EXPECT_EQ(triangles, both);
  }
  // Three triangles at an edge.
  const std::vector<glm::dvec2> rhombus{{0, 0}, {10, 0}, {5, 1}, {5, -1}, {6, 1}};
  std::vector<glm::uvec3> three{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const std::vector<glm::uvec3> before = three;
  flipThinTriangles(rhombus, three);
  EXPECT_EQ(three, before);
}

TEST(CutPolygons, KeepsTheOrderOfFaces) {
  Corners positions = kU;
  positions.emplace_back(-5.0, 0.0, 0.0);
  const std::vector<uint32_t> corners{0, 7, 8, 1, 2, 3, 4, 5, 6, 7, 0, 0, 1, 2, 3, 0, 2, 1, 3, 2, 1};
  const std::vector<uint32_t> sizes{3, 8, 4, 4, 2};
  const CutPolygons cut = cutPolygons(positions, corners, sizes);
  EXPECT_EQ(cut.uncut, 1u);
  ASSERT_EQ(cut.triangles.size(), 1u + 6 + 2 + 2);
  EXPECT_EQ(cut.triangles[0], glm::uvec3(0, 7, 8));
  EXPECT_EQ(cut.triangles[7], glm::uvec3(0, 1, 2));
  EXPECT_EQ(cut.triangles[8], glm::uvec3(0, 2, 3));
  EXPECT_EQ(cut.triangles[9], glm::uvec3(0, 2, 1));
  EXPECT_EQ(cut.triangles[10], glm::uvec3(0, 1, 3));
  double area = 0.0;
  for (size_t t = 1; t < 7; ++t)
    area +=
        areaOf({positions[cut.triangles[t].x], positions[cut.triangles[t].y], positions[cut.triangles[t].z]});
  EXPECT_DOUBLE_EQ(area, 700.0);
}

TEST(CutPolygons, CutsManyAsOne) {
  // More than a task takes, the concave ones first, last and in between.
  Corners positions = kU;
  std::vector<uint32_t> corners, sizes;
  const size_t count = 9000;
  for (size_t p = 0; p < count; ++p) {
    const bool isU = p == 0 || p % 1000 == 7 || p + 1 == count;
    sizes.push_back(isU ? 8 : 4);
    for (uint32_t c = 0; c < sizes.back(); ++c) corners.push_back(isU ? (c + 1) % 8 : c < 3 ? c : 7);
  }
  const CutPolygons cut = cutPolygons(positions, corners, sizes);
  EXPECT_EQ(cut.uncut, 0u);
  const size_t us = 2 + 9;
  ASSERT_EQ(cut.triangles.size(), us * 6 + (count - us) * 2);
  double area = 0.0;
  for (const glm::uvec3& t : cut.triangles) area += areaOf({positions[t.x], positions[t.y], positions[t.z]});
  EXPECT_NEAR(area, 700.0 * double(us) + 900.0 * double(count - us), 1e-3);
}

TEST(CutPolygons, NamesWhatIsWrong) {
  const auto errorOf = [](std::vector<uint32_t> corners, std::vector<uint32_t> sizes) -> std::string {
    try {
      cutPolygons(kU, corners, sizes);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(errorOf({0, 1, 7}, {3}), "");
  EXPECT_EQ(errorOf({0, 1, 2, 0, 1, 8}, {3, 3}), "polygon 1 uses vertex 8, but there are only 8");
  EXPECT_EQ(errorOf({0, 1, 2, 0, 1}, {3, 3}), "polygon 1 has 3 corners, but only 2 are left");
}

}  // namespace
}  // namespace raymap
