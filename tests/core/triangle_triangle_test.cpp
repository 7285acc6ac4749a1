#include "predicates/triangle_triangle.h"

#include <gtest/gtest.h>

#include <random>

namespace raymap {
namespace {

bool areCrossing(const WholeTriangle& a, const WholeTriangle& b, bool areSmall = true) {
  return doCross(a, WholePlane(a), b, areSmall);
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

}  // namespace
}  // namespace raymap
