#include "repair/topology/flat_polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace raymap {
namespace {

using Loop = std::vector<glm::dvec2>;

std::vector<std::vector<FlatCorner>> numbered(const std::vector<Loop>& loops) {
  std::vector<std::vector<FlatCorner>> result;
  uint32_t number = 0;
  for (const Loop& loop : loops) {
    std::vector<FlatCorner>& corners = result.emplace_back();
    for (const glm::dvec2& p : loop) corners.push_back({p, number++});
  }
  return result;
}

double doubleArea(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Checks that triangles cover loops of this area: their number, that each turns left and is not too low, and
/// the sum of their areas.
void expectCovers(const std::vector<Loop>& loops, double area) {
  Loop all;
  for (const Loop& loop : loops) all.insert(all.end(), loop.begin(), loop.end());
  std::vector<glm::uvec3> triangles;
  ASSERT_TRUE(coverPolygon(numbered(loops), triangles));
  EXPECT_EQ(triangles.size(), all.size() + 2 * loops.size() - 4);
  double sum = 0.0;
  for (const glm::uvec3& t : triangles) {
    const glm::dvec2 &a = all[t.x], &b = all[t.y], &c = all[t.z];
    const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    EXPECT_GT(doubleArea(a, b, c), 1e-5 * longest * longest);
    sum += 0.5 * doubleArea(a, b, c);
    for (const glm::dvec2& p : all)  // No corner lies in a triangle.
      EXPECT_FALSE(doubleArea(a, b, p) > 1e-9 && doubleArea(b, c, p) > 1e-9 && doubleArea(c, a, p) > 1e-9);
  }
  EXPECT_NEAR(sum, area, 1e-9 * area);
}

Loop square(double low, double high) {
  return {{low, low}, {high, low}, {high, high}, {low, high}};
}

Loop reversed(Loop loop) {
  std::reverse(loop.begin(), loop.end());
  return loop;
}

/// Adds corners within the edges of a loop.
Loop withCorners(const Loop& loop, int parts) {
  Loop result;
  for (size_t i = 0; i < loop.size(); ++i)
    for (int k = 0; k < parts; ++k)
      result.push_back(loop[i] + double(k) / parts * (loop[(i + 1) % loop.size()] - loop[i]));
  return result;
}

TEST(FlatPolygon, CoversOutlinesOfAnyShape) {
  expectCovers({{{0, 0}, {4, 0}, {0, 3}}}, 6.0);
  expectCovers({square(0, 2)}, 4.0);
  expectCovers({{{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}}, 6.0);                   // L
  expectCovers({{{0, 0}, {5, 0}, {5, 4}, {4, 4}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}}, 11.0);  // U
  expectCovers({{{0, 0}, {1, 1}, {2, 0}, {2, 2}, {1, 1.5}, {0, 2}}}, 2.5);                 // a bow
  expectCovers({withCorners({{0, 0}, {5, 0}, {5, 4}, {4, 4}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}, 7)}, 11.0);
}

TEST(FlatPolygon, CoversAStarAndASpiral) {
  Loop star, spiral;
  for (int i = 0; i < 40; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 40, r = i % 2 == 0 ? 2.0 : 1.0;
    star.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  expectCovers({star}, 20.0 * 2.0 * std::sin(2.0 * std::numbers::pi / 40));
  for (int i = 0; i <= 60; ++i) {
    const double angle = 0.2 * i;
    spiral.emplace_back((3.0 + 0.1 * angle) * std::cos(angle), (3.0 + 0.1 * angle) * std::sin(angle));
  }
  for (int i = 60; i >= 0; --i) {
    const double angle = 0.2 * i;
    spiral.emplace_back((2.8 + 0.1 * angle) * std::cos(angle), (2.8 + 0.1 * angle) * std::sin(angle));
  }
  double area = 0.0;
  for (size_t i = 0; i < spiral.size(); ++i)
    area += 0.5 * doubleArea({0, 0}, spiral[i], spiral[(i + 1) % spiral.size()]);
  expectCovers({area > 0.0 ? spiral : reversed(spiral)}, std::abs(area));
}

TEST(FlatPolygon, CoversWhatIsBesideHoles) {
  expectCovers({square(0, 10), reversed(square(2, 3))}, 99.0);
  expectCovers({withCorners(square(0, 10), 5), withCorners(reversed(square(2, 3)), 3)}, 99.0);
  std::vector<Loop> loops{square(0, 10)};
  for (const glm::dvec2& place : {glm::dvec2(1, 1), glm::dvec2(4, 1), glm::dvec2(1, 5), glm::dvec2(6, 6)}) {
    Loop hole = reversed(square(0, 2));
    for (glm::dvec2& p : hole) p += place;
    loops.push_back(hole);
  }
  expectCovers(loops, 100.0 - 16.0);
  // Behind a wall: the nearest corner cannot be seen.
  expectCovers({{{0, 0}, {10, 0}, {10, 10}, {5.2, 10}, {5.2, 1}, {5, 1}, {5, 10}, {0, 10}},
                {{4.5, 5}, {3, 7}, {4.5, 7}}},
               100.0 - 0.2 * 9.0 - 1.5);
}

TEST(FlatPolygon, RefusesWhatIsNoPolygon) {
  std::vector<glm::uvec3> triangles{{7, 8, 9}};
  const auto isRefused = [&](const std::vector<Loop>& loops) {
    return !coverPolygon(numbered(loops), triangles) && triangles.size() == 1;
  };
  EXPECT_TRUE(isRefused({reversed(square(0, 1))}));
  EXPECT_TRUE(isRefused({{{0, 0}, {1, 0}, {2, 0}}}));
  EXPECT_TRUE(isRefused({square(0, 1), reversed(square(0, 1))}));
}

}  // namespace
}  // namespace raymap
