// The stages over cells, from the mesh to the distance, each compared with the CPU's.

#include <raymap/raymap.h>

#include "cells.h"
#include "cpu/cells/raster_distance.h"
#include "mesh_folder.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanCells : public VulkanTest {};

void expectAsOnTheCpu(const CellMesh& mesh) {
  for (const int reach : {0, 1}) compareRefine(VulkanTest::kept<CellProbe>(), mesh, reach);
  compareRasterDistance(VulkanTest::kept<CellProbe>(), mesh);
}

void expectAsOnTheCpu(const Mesh& mesh, const GridOptions& options) {
  expectAsOnTheCpu(onGrid(mesh, options));
}

TEST_F(VulkanCells, MatchTheCpu) {
  expectAsOnTheCpu(shapes::box({0, 0, 0}, {3, 1, 2}), {.resolution = 20});
  expectAsOnTheCpu(shapes::torus(1.0, 0.3, 60, 30), {.resolution = 24});
  expectAsOnTheCpu(shapes::soup(200, 3), {.resolution = 24});
}

TEST_F(VulkanCells, GiveTheSameBitsEachTime) {
  const Mesh mesh = shapes::joined(shapes::sphere(0.05, 3, {0.4, 0.5, 0.5}), shapes::soup(50, 1));
  const OwnCellMesh cells = onGrid(mesh, {.resolution = 14});
  const CellResult one = kept<CellProbe>().refine(cells, 1), two = kept<CellProbe>().refine(cells, 1);
  EXPECT_TRUE(std::ranges::equal(one.distance, two.distance));
  EXPECT_TRUE(std::ranges::equal(one.triangle, two.triangle));
}

TEST_F(VulkanCells, GiveTiesToTheLowestTriangle) {
  const Mesh twice = shapes::joined(shapes::sphere(1.0, 2), shapes::sphere(1.0, 2));
  const OwnCellMesh cells = onGrid(twice, {.resolution = 8});
  for (const uint32_t t : kept<CellProbe>().refine(cells, 1).triangle)
    ASSERT_LT(t, twice.triangles.size() / 2);
}

TEST_F(VulkanCells, MatchTheCpuInCrowdedCells) {
  expectAsOnTheCpu(shapes::joined(shapes::sphere(0.01, 4, {0.4, 0.5, 0.5}), shapes::soup(3, 1)),
                   {.resolution = 12});
  expectAsOnTheCpu(shapes::sphere(1.0, 5), {.resolution = 6});
}

TEST_F(VulkanCells, MatchTheCpuWhereTheMeshLeavesTheBox) {
  const Mesh torus = shapes::torus(1.0, 0.3, 40, 20);
  for (const Box& box :
       {Box{glm::dvec3(-0.4, -0.5, -0.3), glm::dvec3(0.9, 0.3, 0.5)}, Box{glm::dvec3(2.0), glm::dvec3(3.0)},
        Box{glm::dvec3(-0.2), glm::dvec3(0.2)}, Box{glm::dvec3(1e4), glm::dvec3(1e4 + 1.0)}})
    expectAsOnTheCpu(torus, {.resolution = 16, .box = box});
}

TEST_F(VulkanCells, MatchTheCpuOnThinGrids) {
  for (const glm::ivec3 dims : {glm::ivec3(1, 1, 1), glm::ivec3(1, 1, 50), glm::ivec3(60, 1, 1),
                                glm::ivec3(1, 40, 3), glm::ivec3(17, 33, 1)})
    for (const int count : {1, 50}) expectAsOnTheCpu(cellSoup(count, dims, 5));
}

TEST_F(VulkanCells, GrowTheirListsForLargeTriangles) {
  OwnCellMesh mesh = cellSoup(2, {6, 300, 400}, 2);
  const glm::vec3 corners[6] = {{1, -900, -900}, {3, 900, -900}, {2, 0, 900},
                                {4, -900, 0},    {4, 900, -900}, {5, 900, 900}};
  std::copy_n(corners, 6, mesh.vertices.data());
  Progress progress;
  for (const cpu::CellLevel& level : kept<CellProbe>().rasterDistance(mesh).levels) {
    Buffer<float> squared;
    rasterizeDistance(mesh, level.grid.cells, progress, squared);
    EXPECT_TRUE(std::ranges::equal(level.squared, squared));
  }
}

/// Returns the names of every third mesh that is small and not malformed.
std::vector<std::string> someMeshes() {
  constexpr int kTriangles = 1000;
  std::vector<std::string> names;
  int small = 0;
  for (MeshRow& row : meshRows()) {
    if (row["kind"] == "malformed" || std::atoi(row["triangles"].c_str()) > kTriangles) continue;
    if (small++ % 3 == 0) names.push_back(row["file"]);
  }
  return names;
}

TEST_F(VulkanCells, MatchTheCpuOnRealMeshes) {
  RAYMAP_NEED_MESHES();
  size_t tried = 0;
  for (const std::string& name : someMeshes()) {
    SCOPED_TRACE(name);
    expectAsOnTheCpu(readMesh(meshFolder() / name), {.resolution = 16});
    ++tried;
  }
  EXPECT_GT(tried, 5u);
}

}  // namespace
}  // namespace raymap::vulkan
