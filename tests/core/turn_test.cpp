#include "predicates/turn.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "predicates/int128.h"

namespace raymap {
namespace {

TEST(Turn, HasTheSignOfTheArea) {
  EXPECT_EQ(turn({0, 0}, {2, 0}, {1, 1}), 1);
  EXPECT_EQ(turn({0, 0}, {2, 0}, {1, -1}), -1);
  EXPECT_EQ(turn({0, 0}, {2, 0}, {1, 0}), 0);
  EXPECT_EQ(turn({1, 1}, {1, 1}, {3, 5}), 0);
  EXPECT_EQ(doubleArea({1, 1}, {3, 1}, {1, 5}), 8.0);
  EXPECT_EQ(doubleArea({1, 1}, {1, 5}, {3, 1}), -8.0);
}

TEST(Turn, IsExactNextToALine) {
  // Points around the line through (12, 12) and (24, 24), as far apart as doubles are.
  const double step = std::ldexp(1.0, -53);
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j) {
      const glm::dvec2 p(0.5 + i * step, 0.5 + j * step);
      EXPECT_EQ(turn(p, {12, 12}, {24, 24}), (i < j) - (i > j)) << i << " " << j;
    }
}

TEST(Turn, IsExactForLargeWholeNumbers) {
  std::mt19937_64 random(7);
  const auto number = [&] { return static_cast<int64_t>(random() >> 13) - (int64_t{1} << 50); };
  int onLine = 0;
  for (int i = 0; i < 3000; ++i) {
    const int64_t ax = number(), ay = number(), dx = number() >> 20, dy = number() >> 20;
    const int64_t steps = static_cast<int64_t>(random() % 1000), more = static_cast<int64_t>(random() % 1000);
    const int64_t bx = ax + steps * dx, by = ay + steps * dy;
    const int64_t cx = ax + more * dx + static_cast<int64_t>(random() % 3) - 1, cy = ay + more * dy;
    const Int128 area = Int128(ax - cx) * (by - cy) - Int128(ay - cy) * (bx - cx);
    const int expected = area > 0 ? 1 : area < 0 ? -1 : 0;
    onLine += expected == 0;
    EXPECT_EQ(turn(glm::dvec2(double(ax), double(ay)), glm::dvec2(double(bx), double(by)),
                   glm::dvec2(double(cx), double(cy))),
              expected);
  }
  EXPECT_GT(onLine, 500);
}

TEST(Turn, AddsUpWhatCancels) {
  // Differences of these coordinates round 2^-60 away.
  const double tiny = std::ldexp(1.0, -60);
  EXPECT_EQ(turn({tiny, 0}, {1, 1}, {2, 2}), -1);
  EXPECT_EQ(turn({-tiny, 0}, {1, 1}, {2, 2}), 1);
  EXPECT_EQ(turn({0, 0}, {1, 1}, {2, 2}), 0);
  EXPECT_EQ(turn({1, 1}, {2, 2}, {tiny, 0}), -1);
  EXPECT_EQ(turn({2, 2}, {tiny, 0}, {1, 1}), -1);
}

}  // namespace
}  // namespace raymap
