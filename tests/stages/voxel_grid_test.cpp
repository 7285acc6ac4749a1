#include "cpu/cells/voxel_grid.h"

#include <gtest/gtest.h>
#include <raymap/error.h>

#include <algorithm>
#include <functional>

#include "cells.h"
#include "reference.h"

namespace raymap {

using namespace cpu;
namespace {

constexpr size_t kNoLimit = SIZE_MAX;

VoxelGrid build(const CellMesh& mesh, const CellLattice& cells, int threads = 0) {
  Progress progress;
  VoxelGrid grid;
  withThreads(threads, [&] { buildVoxelGrid(mesh, cells, kNoLimit, progress, grid); });
  return grid;
}
VoxelGrid build(const CellMesh& mesh) {
  return build(mesh, unitCells(mesh));
}

std::vector<uint32_t> list(const VoxelGrid& grid, glm::ivec3 cell) {
  const auto triangles = grid.list(grid.cells.index(cell));
  return {triangles.begin(), triangles.end()};
}

/// Returns by how much a cube around `centre` overlaps (or, if negative, misses) the triangle along the worst
/// of the 13 separating axes, as unit vectors.
double overlap(const CellMesh& mesh, size_t t, const glm::dvec3& centre, double half) {
  glm::dvec3 v[3];
  for (int c = 0; c < 3; ++c) v[c] = glm::dvec3(mesh.corner(t, c)) - centre;
  std::vector<glm::dvec3> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, glm::cross(v[1] - v[0], v[2] - v[0])};
  for (int e = 0; e < 3; ++e)
    for (int u = 0; u < 3; ++u) axes.push_back(glm::cross(v[(e + 1) % 3] - v[e], axes[u]));
  double worst = INFINITY;
  for (const glm::dvec3& axis : axes) {
    const double length = glm::length(axis);
    if (length < 1e-9) continue;
    const double d[3] = {glm::dot(axis, v[0]) / length, glm::dot(axis, v[1]) / length,
                         glm::dot(axis, v[2]) / length};
    const double reach = half * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z)) / length;
    worst = std::min({worst, reach - std::min({d[0], d[1], d[2]}), std::max({d[0], d[1], d[2]}) + reach});
  }
  return worst;
}

void expectSameAsBruteForce(const CellMesh& mesh, const VoxelGrid& grid) {
  const CellLattice& cells = grid.cells;
  size_t touching = 0;
  for (size_t c = 0; c < cells.count(); ++c)
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto held = grid.list(c);
      const bool isHeld = std::binary_search(held.begin(), held.end(), uint32_t(t));
      const double depth = overlap(mesh, t, cells.centre(cells.cell(c)), 0.5 * cells.size);
      touching += isHeld;
      if (std::abs(depth) < 1e-7 * cells.size) continue;
      ASSERT_EQ(isHeld, depth > 0.0) << "triangle " << t << " cell " << c << " depth " << depth;
    }
  EXPECT_GT(touching, 0u);
  EXPECT_EQ(touching, grid.triangles.size());
}

TEST(VoxelGrid, HoldsTheTrianglesThatABoxTestFinds) {
  for (const glm::ivec3 dims : {glm::ivec3(13, 9, 11), glm::ivec3(1, 17, 5), glm::ivec3(20, 1, 1)}) {
    const OwnCellMesh mesh = cellSoup(400, dims, 7);
    expectSameAsBruteForce(mesh, build(mesh));
  }
}

TEST(VoxelGrid, HoldsSliversSegmentsAndPoints) {
  const OwnCellMesh mesh = sliversSegmentsAndPoints();
  expectSameAsBruteForce(mesh, build(mesh));
}

TEST(VoxelGrid, WorksOnCoarserCells) {
  const OwnCellMesh mesh = cellSoup(200, {16, 16, 16}, 9);
  expectSameAsBruteForce(mesh, build(mesh, CellLattice{{9, 7, 5}, {-3.25, 0.5, 1.0}, 2.0}));
}

TEST(VoxelGrid, GivesATriangleOnAFaceToBothCells) {
  OwnCellMesh mesh(shapes::box({0, 0, 0}, {1, 1, 1}), Grid{{4, 4, 4}, glm::dvec3(0.0), 1.0});
  mesh.own = {{0, 1, 2}};
  mesh.triangles = mesh.own;
  mesh.vertices[0] = {1.5f, 0.75f, 0.75f};
  mesh.vertices[1] = {1.5f, 1.25f, 0.75f};
  mesh.vertices[2] = {1.5f, 1.0f, 1.25f};
  const VoxelGrid grid = build(mesh);
  EXPECT_EQ(list(grid, {1, 1, 1}), std::vector<uint32_t>{0});
  EXPECT_EQ(list(grid, {2, 1, 1}), std::vector<uint32_t>{0});
  EXPECT_EQ(grid.triangles.size(), 2u);
}

TEST(VoxelGrid, IsTheSameForAnyNumberOfThreads) {
  const OwnCellMesh mesh = cellSoup(20000, {70, 60, 55}, 1);  // Several blocks of the prefix sum.
  const VoxelGrid one = build(mesh, unitCells(mesh), 1);
  EXPECT_EQ(one.starts[one.cells.count()], one.triangles.size());
  EXPECT_TRUE(std::ranges::is_sorted(one.starts));
  for (size_t c = 0; c < one.cells.count(); ++c)
    ASSERT_TRUE(std::ranges::adjacent_find(one.list(c), std::greater_equal<>()) == one.list(c).end());
  for (const int threads : {2, 8}) {
    const VoxelGrid many = build(mesh, unitCells(mesh), threads);
    EXPECT_TRUE(std::ranges::equal(one.starts, many.starts));
    EXPECT_TRUE(std::ranges::equal(one.triangles, many.triangles));
  }
}

TEST(VoxelGrid, RefusesListsBeyondTheLimit) {
  const OwnCellMesh mesh = cellSoup(500, {9, 12, 15}, 4);
  Progress progress;
  VoxelGrid grid;
  try {
    buildVoxelGrid(mesh, coverMesh(mesh)[0], 1000, progress, grid);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Memory) << error.what();
  }
}

TEST(VoxelGrid, StopsWhenCancelled) {
  const OwnCellMesh mesh = cellSoup(500, {9, 12, 15}, 4);
  Progress progress([](std::string_view, double) { return false; });
  VoxelGrid grid;
  EXPECT_THROW(buildVoxelGrid(mesh, coverMesh(mesh)[0], kNoLimit, progress, grid), Error);
}

TEST(CoverMesh, NeedsOnlyTheSamplesCellsInsideTheBox) {
  const OwnCellMesh mesh(shapes::box({1, 1, 1}, {7, 7, 7}), Grid{{9, 9, 9}, glm::dvec3(0.0), 1.0});
  const auto lattices = coverMesh(mesh);
  ASSERT_EQ(lattices.size(), 1u);
  EXPECT_EQ(lattices[0].dims, glm::ivec3(9, 9, 9));
}

TEST(VoxelGrid, HoldsEveryTriangleWhereverTheBoxLies) {
  for (const double far : {2.0, 100.0, 1e7}) {
    const OwnCellMesh mesh(shapes::box({1, 1, 1}, {7 + far, 7 * far, 7}),
                           Grid{{40, 9, 9}, glm::dvec3(0.0), 1.0});
    const auto lattices = coverMesh(mesh);
    ASSERT_EQ(lattices.size(), 2u);
    EXPECT_LE(lattices[1].count(), 32768u);
    const VoxelGrid grid = build(mesh, lattices[1]);
    std::vector<bool> seen(mesh.triangles.size());
    for (const uint32_t t : grid.triangles) seen[t] = true;
    EXPECT_EQ(std::ranges::count(seen, true), 12);
    const glm::dvec3 last = lattices[1].centre(lattices[1].dims - 1) + 0.5 * lattices[1].size;
    for (int a = 0; a < 3; ++a) {
      EXPECT_LE(lattices[1].first[a] - 0.5 * lattices[1].size, -0.5);
      EXPECT_GE(last[a], mesh.dims[a] - 0.5);
    }
  }
}

}  // namespace
}  // namespace raymap
