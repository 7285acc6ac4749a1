#include "cpu/cells/cell_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "cells.h"
#include "cpu/cells/closest_triangles.h"
#include "cpu/cells/triangle.h"
#include "reference.h"

namespace raymap {

using namespace cpu;
namespace {

double referenceSquared(const CellMesh& mesh, uint32_t t, const glm::dvec3& p) {
  const double d = reference::triangleDistance(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
  return d * d;
}

TEST(TriangleDistance, MeetsTheReferenceOnAllKindsOfTriangles) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> at(-8.0f, 8.0f);
  std::uniform_real_distribution<float> exponent(-7.0f, 0.0f);
  const auto point = [&] { return glm::vec3(at(random), at(random), at(random)); };
  for (int i = 0; i < 200000; ++i) {
    const glm::vec3 p = point(), a = point();
    const float width = i % 5 == 4 ? 0.0f : std::pow(10.0f, exponent(random));
    const glm::vec3 b = i % 7 == 6 ? a : a + point() * (i % 2 ? width : 1.0f);
    const glm::vec3 c = i % 11 == 10 ? a : a + 0.3f * (b - a) + width * point();
    const double expected = reference::triangleDistance(p, a, b, c);
    ASSERT_NEAR(std::sqrt(triangleSquaredDistance(p, a, b, c)), expected, 1e-5) << i;
  }
}

TEST(TriangleDistance, IsTheSameForABatch) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> at(-8.0f, 8.0f);
  OwnCellMesh mesh = cellSoup(900, {12, 12, 12}, 6);
  for (size_t t = 0; t < 900; t += 3) mesh.vertices[3 * t + 2] = mesh.vertices[3 * t + t % 2];  // degenerate
  std::vector<uint32_t> all(900);
  std::iota(all.begin(), all.end(), 0);
  PointBatch batch;
  batch.count = 101;
  for (size_t i = 0; i < batch.count; ++i) {
    batch.x[i] = 4.0f + at(random), batch.y[i] = 4.0f + at(random), batch.z[i] = 4.0f + at(random);
    batch.squared[i] = INFINITY;
  }
  findClosestTriangles(mesh, all, batch);
  for (size_t i = 0; i < batch.count; ++i) {
    const glm::vec3 p(batch.x[i], batch.y[i], batch.z[i]);
    double closest = INFINITY;
    for (const uint32_t t : all) closest = std::min(closest, referenceSquared(mesh, t, p));
    ASSERT_NEAR(std::sqrt(batch.squared[i]), std::sqrt(closest), 1e-5);
    ASSERT_NEAR(std::sqrt(referenceSquared(mesh, batch.triangle[i], p)), std::sqrt(closest), 1e-5);
  }
}

TEST(CellDistance, IsTheDistanceFromTheCentreToTheTrianglesOfTheCell) {
  const OwnCellMesh mesh = cellSoup(300, {11, 7, 9}, 6);
  for (const CellLattice& cells : {unitCells(mesh), CellLattice{{4, 3, 5}, glm::dvec3(-1.0), 4.0}}) {
    Progress progress;
    VoxelGrid grid;
    buildVoxelGrid(mesh, cells, SIZE_MAX, progress, grid);
    Buffer<float> squared;
    computeCellDistance(mesh, grid, progress, squared);
    ASSERT_EQ(squared.size(), cells.count());
    for (size_t c = 0; c < cells.count(); ++c) {
      double expected = INFINITY;
      for (const uint32_t t : grid.list(c))
        expected = std::min(expected, referenceSquared(mesh, t, cells.centre(cells.cell(c))));
      if (grid.list(c).empty()) {
        EXPECT_EQ(squared[c], emptyCell(cells.dims));
      } else {
        EXPECT_NEAR(squared[c], expected / (cells.size * cells.size), 1e-5);
        EXPECT_LE(squared[c], 0.75f + 1e-5f);  // A cell's centre is that close to all of the cell.
      }
    }
  }
}

TEST(CellDistance, EmptyIsBeyondEveryDistanceInTheGrid) {
  const glm::ivec3 dims(200, 3, 1000);
  const glm::vec3 diagonal(dims - 1);
  EXPECT_GT(emptyCell(dims), glm::dot(diagonal, diagonal) + 0.75f);
  EXPECT_TRUE(std::isfinite(emptyCell(glm::ivec3(1 << 20))));
}

}  // namespace
}  // namespace raymap
