#include "cpu/cells/raster_distance.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "cells.h"
#include "reference.h"
#include "twins.h"
#ifdef RAYMAP_TEST_VULKAN
#include "vulkan_cell_stages.h"
#endif

namespace raymap {

using namespace cpu;
namespace {

std::vector<CellLevel> rasterizeOnCpu(const CellMesh& mesh, int threads = 0) {
  Progress progress;
  std::vector<CellLevel> levels;
  withThreads(threads, [&] {
    for (const CellLattice& cells : coverMesh(mesh)) {
      CellLevel& level = levels.emplace_back();
      level.grid.cells = cells;
      rasterizeDistance(mesh, cells, progress, level.squared);
    }
  });
  return levels;
}

Buffer<float> rasterDistanceOnCpu(const CellMesh& mesh) {
  Progress progress;
  std::vector<CellLevel> levels = rasterizeOnCpu(mesh);
  for (CellLevel& level : levels)
    transformDistance(level.grid.cells.dims, progress, level.squared, level.nearestCell);
  Buffer<float> distance;
  sampleRasterDistance(mesh.dims, levels, progress, distance);
  return distance;
}

class RasterDistanceTwins : public TwinTest {
 protected:
  static std::vector<CellLevel> rasterize(const CellMesh& mesh) {
#ifdef RAYMAP_TEST_VULKAN
    if (!isOnCpu()) return vulkan::CellStages::probe().rasterize(mesh);
#endif
    return rasterizeOnCpu(mesh);
  }
  static Buffer<float> rasterDistance(const CellMesh& mesh) {
#ifdef RAYMAP_TEST_VULKAN
    if (!isOnCpu()) return vulkan::CellStages::probe().rasterDistance(mesh);
#endif
    return rasterDistanceOnCpu(mesh);
  }

  /// |p - q|^2 + f(q), where q is the best cell, d the true distance. From above: (d + sqrt(3)/2)^2 + 3/4, as
  /// in refine_test.cpp; from below: |p - q| + sqrt(f(q)) >= d and f(q) <= 3/4. `slack` is how far
  /// the sample lies from the centre that the transform searched from.
  static void expectWithinBounds(const OwnCellMesh& mesh) {
    const double size = coverMesh(mesh).back().size;
    const double slack = coverMesh(mesh).size() > 1 ? std::sqrt(3.0) * size : 0.0;
    const Mesh truth = mesh.asMesh();
    const Buffer<float> distance = rasterDistance(mesh);
    for (size_t s = 0; s < distance.size(); s += 7) {
      const double expected = reference::distance(truth, glm::dvec3(CellLattice{mesh.dims}.cell(s)));
      const double half = std::sqrt(0.75);
      const double upper = size * std::hypot(expected / size + half, half) + slack;
      ASSERT_LE(distance[s], upper + 1e-4) << s;
      ASSERT_GE(distance[s], expected - half * size - 1e-4) << s;
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Twins, RasterDistanceTwins, allTwins(), twinName);

TEST_P(RasterDistanceTwins, IsWhatTheListsGive) {
  Progress progress;
  const OwnCellMesh mesh = cellSoup(2000, {33, 20, 27}, 3);
  std::vector<CellLevel> levels = rasterize(mesh);
  ASSERT_EQ(levels.size(), 2u);
  for (const CellLevel& level : levels) {
    VoxelGrid grid;
    buildVoxelGrid(mesh, level.grid.cells, SIZE_MAX, progress, grid);
    Buffer<float> expected;
    computeCellDistance(mesh, grid, progress, expected);
    EXPECT_TRUE(std::ranges::equal(level.squared, expected));
  }
}

TEST_P(RasterDistanceTwins, ErrsByNoMoreThanTheTheorySays) {
  for (const Mesh& mesh : {shapes::sphere(1.0, 4), shapes::torus(1.0, 0.3, 60, 30), shapes::soup(100, 2)})
    expectWithinBounds({mesh, fitGrid(mesh, {.resolution = 30})});
}

TEST_P(RasterDistanceTwins, SeesTheMeshOutsideTheBox) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 60, 30);
  for (const Box& box : {Box{glm::dvec3(-0.4, -0.5, -0.3), glm::dvec3(0.9, 0.3, 0.5)},
                         Box{glm::dvec3(2.0), glm::dvec3(3.0)}, Box{glm::dvec3(-0.2), glm::dvec3(0.2)}})
    expectWithinBounds({mesh, fitGrid(mesh, {.resolution = 20, .box = box})});
}

TEST(RasterDistance, IsTheSameForAnyNumberOfThreads) {
  const OwnCellMesh mesh = cellSoup(20000, {20, 30, 25}, 1);
  const std::vector<CellLevel> one = rasterizeOnCpu(mesh, 1);
  for (const int threads : {2, 8}) {
    const std::vector<CellLevel> many = rasterizeOnCpu(mesh, threads);
    for (size_t l = 0; l < one.size(); ++l) EXPECT_TRUE(std::ranges::equal(one[l].squared, many[l].squared));
  }
}

}  // namespace
}  // namespace raymap
