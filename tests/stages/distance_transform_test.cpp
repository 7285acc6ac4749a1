#include "cpu/cells/distance_transform.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "cells.h"
#include "cpu/cells/cell_distance.h"
#include "twins.h"
#ifdef RAYMAP_TEST_VULKAN
#include "vulkan_cell_stages.h"
#endif

namespace raymap {

using namespace cpu;
namespace {

struct Result {
  Buffer<float> squared;
  Buffer<uint32_t> cells;
};

Result transformOnCpu(glm::ivec3 dims, const Buffer<float>& squared, int threads = 0) {
  Progress progress;
  Result result{squared.clone(), {}};
  withThreads(threads, [&] { transformDistance(dims, progress, result.squared, result.cells); });
  return result;
}

class DistanceTransformTwins : public TwinTest {
 protected:
  static Result transform(glm::ivec3 dims, const Buffer<float>& squared) {
#ifdef RAYMAP_TEST_VULKAN
    if (!isOnCpu()) {
      vulkan::TransformResult result = vulkan::CellStages::probe().transform(dims, squared);
      return {std::move(result.squared), std::move(result.cells)};
    }
#endif
    return transformOnCpu(dims, squared);
  }
};
INSTANTIATE_TEST_SUITE_P(Twins, DistanceTransformTwins, allTwins(), twinName);

void expectMinimum(glm::ivec3 dims, const Buffer<float>& f, const Result& result) {
  const CellLattice cells{dims};
  for (size_t p = 0; p < f.size(); ++p) {
    double best = INFINITY;
    size_t nearest = 0;
    for (size_t q = 0; q < f.size(); ++q) {
      if (f[q] >= emptyCell(dims)) continue;
      const glm::dvec3 d(cells.cell(p) - cells.cell(q));
      const double value = glm::dot(d, d) + f[q];
      if (value < best) best = value, nearest = q;
    }
    ASSERT_NEAR(result.squared[p], best, 1e-6 * best + 1e-6) << p;
    const uint32_t q = result.cells[p];
    const glm::dvec3 d(cells.cell(p) - cells.cell(q));
    ASSERT_NEAR(glm::dot(d, d) + f[q], best, 1e-6 * best + 1e-6) << p << " nearest " << q;
    if (f[q] == 0.0f && f[nearest] == 0.0f) {
      ASSERT_EQ(q, nearest) << "a tie must go to the lowest z, y, x";
    }
  }
}

TEST_P(DistanceTransformTwins, IsTheMinimumOverAllCells) {
  unsigned seed = 0;
  for (const glm::ivec3 dims : {glm::ivec3(14, 9, 11), glm::ivec3(1, 33, 20), glm::ivec3(70, 1, 13),
                                glm::ivec3(37, 21, 1), glm::ivec3(1, 1, 300), glm::ivec3(1, 1, 1)})
    for (const double share : {0.004, 0.1, 1.0}) {
      Buffer<float> f = randomCells(dims, share, ++seed);
      f[f.size() / 2] = 0.25f;
      expectMinimum(dims, f, transform(dims, f));
    }
}

TEST_P(DistanceTransformTwins, GivesTiesToTheLowestCell) {
  const glm::ivec3 dims(13, 10, 12);
  const Buffer<float> f = randomCells(dims, 0.02, 77, true);
  expectMinimum(dims, f, transform(dims, f));
}

TEST_P(DistanceTransformTwins, LeavesAnEmptyGridEmpty) {
  const glm::ivec3 dims(5, 40, 3);
  const Result result = transform(dims, randomCells(dims, 0.0, 1));
  EXPECT_EQ(std::ranges::count(result.cells, kNoCell), 600);
  EXPECT_EQ(std::ranges::count(result.squared, emptyCell(dims)), 600);
}

TEST_P(DistanceTransformTwins, KeepsItsDigitsOnLongLines) {
  // The border of two parabolas lies just above 1000: float arithmetic on q^2 would move it.
  const glm::ivec3 dims(2001, 1, 1);
  Buffer<float> f(2001);
  std::fill(f.begin(), f.end(), emptyCell(dims));
  f[0] = 0.3f;
  f[2000] = 0.301f;
  const Result result = transform(dims, f);
  for (uint32_t p = 0; p < 2001; ++p) EXPECT_EQ(result.cells[p], p <= 1000 ? 0u : 2000u) << p;
}

TEST_P(DistanceTransformTwins, GivesTiesToTheLowestCellOnLongLines) {
  // The middle of 299 and 1749 comes out below 1024 if it is computed with the reciprocal of their
  // difference.
  const glm::ivec3 dims(2001, 1, 1);
  Buffer<float> f(2001);
  for (const uint32_t low : {299U, 0U, 98U})
    for (const uint32_t high : {1749U, 98U, 1998U}) {
      if (high <= low) continue;
      std::fill(f.begin(), f.end(), emptyCell(dims));
      f[low] = f[high] = 0.3f;
      const Result result = transform(dims, f);
      for (uint32_t p = 0; p < 2001; ++p)
        ASSERT_EQ(result.cells[p], 2 * p <= low + high ? low : high) << p << " of " << low << ", " << high;
    }
}

TEST(DistanceTransform, IsTheSameForAnyNumberOfThreads) {
  const glm::ivec3 dims(70, 90, 65);
  const Buffer<float> f = randomCells(dims, 0.01, 5);
  const Result one = transformOnCpu(dims, f, 1);
  for (const int threads : {2, 8}) {
    const Result many = transformOnCpu(dims, f, threads);
    EXPECT_TRUE(std::ranges::equal(one.squared, many.squared));
    EXPECT_TRUE(std::ranges::equal(one.cells, many.cells));
  }
}

TEST_P(DistanceTransformTwins, IsTheSameForAnyOrderOfAxes) {
  const CellLattice cells{{17, 12, 9}}, turned{{9, 17, 12}};
  const Buffer<float> f = randomCells(cells.dims, 0.02, 6);
  Buffer<float> g(f.size());
  const auto turn = [&](size_t index) {
    const glm::ivec3 c = cells.cell(index);
    return turned.index({c.z, c.x, c.y});
  };
  // Both grids have the same empty value, and no two distances tie.
  for (size_t c = 0; c < f.size(); ++c) g[turn(c)] = f[c];
  const Result here = transform(cells.dims, f), there = transform(turned.dims, g);
  for (size_t c = 0; c < f.size(); ++c) {
    ASSERT_NEAR(here.squared[c], there.squared[turn(c)], 1e-5);
    ASSERT_EQ(turn(here.cells[c]), there.cells[turn(c)]);
  }
}

}  // namespace
}  // namespace raymap
