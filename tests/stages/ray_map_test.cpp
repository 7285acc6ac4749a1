#include "cpu/sign/ray_map.h"

#include <gtest/gtest.h>

#include <atomic>

#include "cpu/sign/ray_sweep.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {

using namespace cpu;
namespace {

glm::ivec3 unit(int axis) {
  glm::ivec3 e(0);
  e[axis] = 1;
  return e;
}

const Grid kSoupGrid{.dims = {11, 13, 17}, .origin = {0.07, 0.02, 0.05}, .spacing = 0.071};

RayMap soupMap(const Grid& grid) {
  return rayMapOf(shapes::soup(300, 5), grid);
}

TEST(RayMap, AConvexBodyGivesOneInsideAndNoneOutside) {
  const Grid grid{.dims = {8, 8, 8}, .origin = glm::dvec3(0.0), .spacing = 1.0};
  const RayMap map = rayMapOf(shapes::box({1.5, 1.5, 1.5}, {5.5, 5.5, 5.5}), grid);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(map.ray(axis, {3, 3, 3}), 1);
    EXPECT_EQ(map.unsignedRay(axis, {3, 3, 3}), 1);
    EXPECT_EQ(map.ray(axis, {1, 1, 1}), 0);
    const glm::ivec3 before = glm::ivec3(3) - 3 * unit(axis), after = glm::ivec3(3) + 3 * unit(axis);
    EXPECT_EQ(map.ray(axis, before), 0);
    EXPECT_EQ(map.unsignedRay(axis, before), 2);
    EXPECT_EQ(map.ray(axis, after), 0);
    EXPECT_EQ(map.unsignedRay(axis, after), 0);
  }
}

TEST(RayMap, SegmentsAreAntisymmetricAndAddUp) {  // Eq. 2 and 6
  const RayMap map = soupMap(kSoupGrid);
  for (int axis = 0; axis < 3; ++axis)
    for (int a = -2; a < 19; ++a)
      for (int b = -2; b < 19; ++b) {
        glm::ivec3 from(5, 6, 7), to = from;
        from[axis] = a;
        to[axis] = b;
        EXPECT_EQ(map.segment(axis, from, b), -map.segment(axis, to, a));
        EXPECT_EQ(
            map.segment(axis, from, b),
            map.segment(axis, from, 4) + map.ray(axis, from - (a - 4) * unit(axis)) - map.ray(axis, to));
      }
}

TEST(RayMap, OutsideTheGrid) {  // Eq. 7
  const RayMap map = soupMap(kSoupGrid);
  for (int axis = 0; axis < 3; ++axis) {
    const glm::ivec3 inside(5, 6, 7), e = unit(axis);
    glm::ivec3 beyond = inside, before = inside;
    beyond[axis] = kSoupGrid.dims[axis];
    before[axis] = -1;
    EXPECT_EQ(map.ray(axis, beyond), 0);
    EXPECT_EQ(map.ray(axis, beyond + 100 * e), 0);
    EXPECT_EQ(map.ray(axis, before), map.ray(axis, before - 100 * e));
    const LineAxes across(axis);
    EXPECT_EQ(map.ray(axis, before),
              map.total(axis, size_t(inside[across.v]) * kSoupGrid.dims[across.u] + inside[across.u]));
    glm::ivec3 beside = inside;
    beside[across.u] = -1;
    EXPECT_EQ(map.ray(axis, beside), 0);
    beside[across.u] = kSoupGrid.dims[across.u];
    EXPECT_EQ(map.ray(axis, beside), 0);
  }
}

TEST(RayMap, SweepStreamsTheSameValues) {
  const RayMap map = rayMapOf(shapes::soup(300, 5), kSoupGrid);
  std::atomic<size_t> rows{0};  // slabs run in parallel
  RaySweep(map).run([&](const RayRow& row) {
    ++rows;
    const auto total = [&](int axis, glm::ivec3 s) {
      s[axis] = -1;
      return map.ray(axis, s);
    };
    for (int i = 0; i < kSoupGrid.dims.x; ++i) {
      const glm::ivec3 s(i, row.j, row.k);
      ASSERT_EQ(row.x[i], map.ray(0, s));
      ASSERT_EQ(row.y[i], map.ray(1, s));
      ASSERT_EQ(row.z[i], map.ray(2, s));
      ASSERT_EQ(row.totalX, total(0, s));
      ASSERT_EQ(row.totalY[i], total(1, s));
      ASSERT_EQ(row.totalZ[i], total(2, s));
    }
  });
  EXPECT_EQ(rows.load(), size_t(kSoupGrid.dims.y * kSoupGrid.dims.z));
}

}  // namespace
}  // namespace raymap
