#include "vulkan/stages/voxel_grid.h"

#include "cells.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanVoxelGrid : public VulkanTest {
 protected:
  static void expectAsOnTheCpu(const CellMesh& mesh) {
    for (const CellLattice& cells : coverMesh(mesh)) compareVoxelGrid(kept<CellProbe>(), mesh, cells);
  }
  static void expectAsOnTheCpu(const Mesh& mesh, const GridOptions& options) {
    expectAsOnTheCpu(onGrid(mesh, options));
  }
};

TEST_F(VulkanVoxelGrid, MatchesTheCpu) {
  unsigned seed = 0;
  for (const glm::ivec3 dims : {glm::ivec3(13, 9, 11), glm::ivec3(1, 17, 5), glm::ivec3(20, 1, 1),
                                glm::ivec3(1, 1, 40), glm::ivec3(1, 1, 1), glm::ivec3(48, 40, 33)})
    for (const int count : {1, 400, 5000}) expectAsOnTheCpu(cellSoup(count, dims, ++seed));
  compareVoxelGrid(kept<CellProbe>(), cellSoup(200, {16, 16, 16}, 9), {{9, 7, 5}, {-3.25, 0.5, 1.0}, 2.0});
}

TEST_F(VulkanVoxelGrid, MatchesTheCpuOnRegularMeshes) {
  expectAsOnTheCpu(shapes::box({0, 0, 0}, {3, 1, 2}), {.resolution = 24});
  expectAsOnTheCpu(shapes::sphere(1.0, 4), {.resolution = 40});
  expectAsOnTheCpu(shapes::sphere(0.02, 4), {.resolution = 8, .box = Box{glm::dvec3(-1), glm::dvec3(1)}});
  const Mesh torus = shapes::torus(1.0, 0.3, 60, 30);
  for (const Box& box : {Box{glm::dvec3(2.0), glm::dvec3(3.0)}, Box{glm::dvec3(-0.4), glm::dvec3(0.9)}})
    expectAsOnTheCpu(torus, {.resolution = 20, .box = box});
  for (const double far : {2.0, 100.0, 1e7})
    expectAsOnTheCpu(
        OwnCellMesh(shapes::box({1, 1, 1}, {7 + far, 7 * far, 7}), {{40, 9, 9}, glm::dvec3(0.0), 1.0}));
}

TEST_F(VulkanVoxelGrid, MatchesTheCpuOnSliversSegmentsAndPoints) {
  OwnCellMesh mesh = sliversSegmentsAndPoints();
  for (size_t t = 0; t < 300; ++t) {
    glm::vec3* v = mesh.vertices.data() + 3 * t;
    if (t % 4 == 0)
      for (int c = 0; c < 3; ++c) v[c] = glm::round(2.0f * v[c]) / 2.0f;  // On faces and centres of cells.
    if (t % 25 == 0) v[2] = v[2] * 1e30f;
    if (t % 40 == 0) std::copy_n(v, 3, mesh.vertices.data());  // The same triangle twice.
  }
  compareVoxelGrid(kept<CellProbe>(), mesh, unitCells(mesh));
}

TEST_F(VulkanVoxelGrid, IsEmptyForTrianglesFarAway) {
  OwnCellMesh mesh = cellSoup(100, {10, 10, 10}, 8);
  for (glm::vec3& v : mesh.vertices) v += glm::vec3(1e5f, -3.0f, 2e20f);
  compareVoxelGrid(kept<CellProbe>(), mesh, unitCells(mesh));
  EXPECT_TRUE(kept<CellProbe>().voxelGrid(mesh, unitCells(mesh)).triangles.empty());
}

TEST_F(VulkanVoxelGrid, GrowsItsListsForLargeTriangles) {
  const OwnCellMesh small = cellSoup(2, {8, 400, 400}, 1);
  OwnCellMesh large = cellSoup(2, {8, 400, 400}, 2);
  const glm::vec3 corners[6] = {{1, -900, -900}, {3, 900, -900}, {2, 0, 900},
                                {6, -900, 0},    {6, 900, -900}, {5, 900, 900}};
  std::copy_n(corners, 6, large.vertices.data());
  const CellLattice cells = unitCells(large);
  VoxelGridStage grid(device());
  const UploadedMesh few = kept<CellProbe>().upload(small), many = kept<CellProbe>().upload(large);
  const auto runs = [&](const UploadedMesh& mesh) {
    return kept<CellProbe>().runUntilItFits(
        grid, [&](const ListSizes& lists) { grid.reserve(cells, 2, lists); },
        [&](Commands& commands) { grid.record(commands, mesh.addresses()); });
  };
  EXPECT_EQ(runs(few), 1);
  EXPECT_GT(runs(many), 1);
  EXPECT_EQ(runs(few), 1);
  CellProbe probe(device());
  for (const CellMesh* mesh : std::initializer_list<const CellMesh*>{&small, &large, &small})
    compareVoxelGrid(probe, *mesh, cells);
}

TEST_F(VulkanVoxelGrid, RefusesMoreEntriesThanCanBeNumbered) {
  // 1000 triangles, each across all of 2000 x 2000 rows of one cell.
  OwnCellMesh mesh = cellSoup(1000, {1, 2000, 2000}, 1);
  for (size_t t = 0; t < 1000; ++t) {
    glm::vec3* v = mesh.vertices.data() + 3 * t;
    v[0] = {0, -9e3f, -9e3f}, v[1] = {0, 9e3f, -9e3f}, v[2] = {0, 0, 9e3f};
  }
  VoxelGridStage grid(device());
  const UploadedMesh uploaded = kept<CellProbe>().upload(mesh);
  const CellLattice cells = unitCells(mesh);
  grid.reserve(cells, 1000);
  run([&](Commands& commands) { grid.record(commands, uploaded.addresses()); });
  EXPECT_FALSE(grid.fits(kept<CellProbe>().sizes(grid)));
  try {
    grid.reserve(cells, 1000, kept<CellProbe>().sizes(grid));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Memory) << error.what();
  }
}

}  // namespace
}  // namespace raymap::vulkan
