#include "predicates/line_triangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "shapes.h"

namespace raymap {
namespace {

TEST(LineTriangle, LinesThroughEdgesAndCornersCrossOneSideOnce) {
  const Mesh mesh = shapes::box({0, 0, 0}, {2, 2, 2});
  const auto crossings = [&](double y, double z) {
    std::vector<double> xs;
    for (const glm::uvec3& t : mesh.triangles)
      if (const auto x = crossingAt(mesh.position(t.x), mesh.position(t.y), mesh.position(t.z), y, z))
        xs.push_back(*x);
    std::sort(xs.begin(), xs.end());
    return xs;
  };
  const std::vector<double> both{0.0, 2.0};
  // Lines count as moved a little along y and less along z, so that the low sides are inside.
  for (const double low : {0.0, 0.25, 1.0, 1.5})
    for (const double other : {0.0, 0.5, 1.0, 1.999}) EXPECT_EQ(crossings(low, other), both);
  for (const double other : {-1.0, 0.0, 1.0, 2.0, 3.0}) {
    EXPECT_TRUE(crossings(2.0, other).empty());
    EXPECT_TRUE(crossings(other, 2.0).empty());
    EXPECT_TRUE(crossings(-0.001, other).empty());
    EXPECT_TRUE(crossings(other, 2.001).empty());
  }
}

TEST(LineTriangle, CrossingsLieInTheTriangle) {
  const glm::dvec3 a(1, 0, 0), b(3, 4, 0), c(5, 0, 4);
  EXPECT_EQ(crossingAt(a, b, c, 1, 1), 2.5);
  EXPECT_EQ(crossingAt(c, b, a, 1, 1), 2.5);
  EXPECT_EQ(crossingAt(a, b, c, 3, 1.5), std::nullopt);
  EXPECT_EQ(crossingAt({0, 0, 0}, {1, 2, 2}, {2, 1, 1}, 1, 1), std::nullopt);  // Parallel to x.
}

TEST(LineTriangle, PassagesHaveASideAndWeights) {
  const glm::dvec2 a(-1, -1), b(3, -1), c(-1, 3);
  const LinePassage passage = passLine(a, b, c);
  EXPECT_EQ(passage.side, 1);
  EXPECT_EQ(passage.weights, glm::dvec3(8, 4, 4));
  EXPECT_EQ(passLine(a, c, b).side, -1);
  EXPECT_EQ(passLine(a, c, b).weights, glm::dvec3(-8, -4, -4));
  EXPECT_EQ(passLine(a + 2.5, b + 2.5, c + 2.5).side, 0);
  EXPECT_EQ(passLine(a, a, b).side, 0);
}

TEST(LineTriangle, TiesArePassedByAStepAlongMinusXAndLessAlongMinusY) {
  // Squares of two triangles; the origin lies on a side, in a corner or on the diagonal.
  const auto passages = [](const glm::dvec2& low) {
    const glm::dvec2 b = low + glm::dvec2(2, 0), c = low + 2.0, d = low + glm::dvec2(0, 2);
    return passLine(low, b, c).side + passLine(low, c, d).side;
  };
  for (const glm::dvec2 low : {glm::dvec2(-2, -1), {-2, -2}, {-1, -1}, {-0.5, -0.5}, {-1, -2}})
    EXPECT_EQ(passages(low), 1) << low.x << " " << low.y;
  for (const glm::dvec2 low : {glm::dvec2(0, -1), {0, 0}, {-1, 0}, {0, -2}, {-2, 0}})
    EXPECT_EQ(passages(low), 0) << low.x << " " << low.y;
}

TEST(LineTriangle, ClosedSurfacesAreEnteredAsOftenAsLeft) {
  // Tetrahedra with whole coordinates, so that most lines meet edges or corners.
  std::mt19937 random(5);
  std::uniform_int_distribution<int> whole(-2, 2);
  size_t passed = 0;
  for (int i = 0; i < 20000; ++i) {
    glm::dvec2 p[4];
    for (glm::dvec2& corner : p) corner = {whole(random), whole(random)};
    int sum = 0;
    for (const glm::uvec3& t : {glm::uvec3(0, 2, 1), {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) {
      const int side = passLine(p[t.x], p[t.y], p[t.z]).side;
      sum += side;
      passed += side > 0 ? 1 : 0;
    }
    ASSERT_EQ(sum, 0);
  }
  EXPECT_GT(passed, 2000u);
}

}  // namespace
}  // namespace raymap
