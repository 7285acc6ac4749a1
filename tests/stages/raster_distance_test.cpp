#include "cpu/cells/raster_distance.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "cells.h"
#include "reference.h"

namespace raymap {

using namespace cpu;
namespace {

std::vector<CellLevel> rasterize(const CellMesh& mesh) {
  Progress progress;
  std::vector<CellLevel> levels;
  for (const CellLattice& cells : coverMesh(mesh)) {
    CellLevel& level = levels.emplace_back();
    level.grid.cells = cells;
    rasterizeDistance(mesh, cells, progress, level.squared);
  }
  return levels;
}

Buffer<float> rasterDistance(const CellMesh& mesh) {
  Progress progress;
  std::vector<CellLevel> levels = rasterize(mesh);
  for (CellLevel& level : levels)
    transformDistance(level.grid.cells.dims, progress, level.squared, level.nearestCell);
  Buffer<float> distance;
  sampleRasterDistance(mesh.dims, levels, progress, distance);
  return distance;
}

/// |p - q|^2 + f(q), where q is the best cell, d the true distance. From above: (d + sqrt(3)/2)^2 + 3/4, as
/// in refine_test.cpp; from below: |p - q| + sqrt(f(q)) >= d and f(q) <= 3/4. `slack` is how far the sample
/// lies from the centre that the transform searched from.
void expectRasterWithinBounds(const OwnCellMesh& mesh) {
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

TEST(RasterDistance, IsWhatTheListsGive) {
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

TEST(RasterDistance, ErrsByNoMoreThanTheTheorySays) {
  for (const Mesh& mesh : {shapes::sphere(1.0, 4), shapes::torus(1.0, 0.3, 60, 30), shapes::soup(100, 2)})
    expectRasterWithinBounds(onGrid(mesh, {.resolution = 30}));
}

TEST(RasterDistance, SeesTheMeshOutsideTheBox) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 60, 30);
  for (const Box& box : {Box{glm::dvec3(-0.4, -0.5, -0.3), glm::dvec3(0.9, 0.3, 0.5)},
                         Box{glm::dvec3(2.0), glm::dvec3(3.0)}, Box{glm::dvec3(-0.2), glm::dvec3(0.2)}})
    expectRasterWithinBounds(onGrid(mesh, {.resolution = 20, .box = box}));
}

}  // namespace
}  // namespace raymap
