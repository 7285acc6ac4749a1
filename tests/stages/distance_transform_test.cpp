#include "cpu/cells/distance_transform.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "cells.h"
#include "cpu/cells/cell_distance.h"

namespace raymap {

using namespace cpu;
namespace {

struct Result {
  Buffer<float> squared;
  Buffer<uint32_t> cells;
};

Result transform(glm::ivec3 dims, const Buffer<float>& squared) {
  Progress progress;
  Result result{squared.clone(), {}};
  transformDistance(dims, progress, result.squared, result.cells);
  return result;
}

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

TEST(DistanceTransform, IsTheMinimumOverAllCells) {
  unsigned seed = 0;
  for (const glm::ivec3 dims : {glm::ivec3(14, 9, 11), glm::ivec3(1, 33, 20), glm::ivec3(70, 1, 13),
                                glm::ivec3(37, 21, 1), glm::ivec3(1, 1, 300), glm::ivec3(1, 1, 1)})
    for (const double share : {0.004, 0.1, 1.0}) {
      Buffer<float> f = randomCells(dims, share, ++seed);
      f[f.size() / 2] = 0.25f;
      expectMinimum(dims, f, transform(dims, f));
    }
}

TEST(DistanceTransform, GivesTiesToTheLowestCell) {
  const glm::ivec3 dims(13, 10, 12);
  const Buffer<float> f = randomCells(dims, 0.02, 77, true);
  expectMinimum(dims, f, transform(dims, f));
}

TEST(DistanceTransform, LeavesAnEmptyGridEmpty) {
  const glm::ivec3 dims(5, 40, 3);
  const Result result = transform(dims, randomCells(dims, 0.0, 1));
  EXPECT_EQ(std::ranges::count(result.cells, kNoCell), 600);
  EXPECT_EQ(std::ranges::count(result.squared, emptyCell(dims)), 600);
}

TEST(DistanceTransform, KeepsItsDigitsOnLongLines) {
  for (const TwoCells& two : closeCells()) {
    const Buffer<float> f = two.squared();
    const Result result = transform({f.size(), 1, 1}, f);
    for (uint32_t p = 0; p < f.size(); ++p)
      ASSERT_EQ(result.cells[p], p <= two.last ? two.low : two.high) << p;
  }
}

}  // namespace
}  // namespace raymap
