#include "vulkan/stages/voxel_grid.h"

#include "vulkan_cell_stages.h"

namespace raymap::vulkan {
namespace {

cpu::VoxelGrid onTheCpu(const CellMesh& mesh, const CellLattice& cells) {
  Progress progress;
  cpu::VoxelGrid grid;
  buildVoxelGrid(mesh, cells, SIZE_MAX, progress, grid);
  return grid;
}

bool areSame(const cpu::VoxelGrid& a, const cpu::VoxelGrid& b) {
  return std::ranges::equal(a.starts, b.starts) && std::ranges::equal(a.triangles, b.triangles);
}

class VulkanVoxelGrid : public VulkanTest {
 protected:
  static void expectAsOnTheCpu(VoxelGridStage& grid, const CellMesh& mesh, const CellLattice& cells) {
    const UploadedMesh uploaded = CellStages::probe().upload(mesh);
    const auto record = [&](Commands& commands) { grid.record(commands, uploaded.addresses()); };
    CellStages::probe().runUntilItFits(
        grid, [&](const ListSizes& lists) { grid.reserve(cells, uploaded.addresses().triangleCount, lists); },
        record);
    const cpu::VoxelGrid ours = CellStages::probe().toLists(grid);
    EXPECT_TRUE(areSame(ours, onTheCpu(mesh, cells)));
    run(record);
    EXPECT_TRUE(areSame(CellStages::probe().toLists(grid), ours)) << "the second time";
  }

  static void expectAsOnTheCpu(VoxelGridStage& grid, const CellMesh& mesh) {
    for (const CellLattice& cells : coverMesh(mesh)) {
      SCOPED_TRACE(::testing::Message() << cells.count() << " cells of size " << cells.size);
      expectAsOnTheCpu(grid, mesh, cells);
    }
  }
};

OwnCellMesh onGrid(const Mesh& mesh, const GridOptions& options) {
  return {mesh, fitGrid(mesh, options)};
}

TEST_F(VulkanVoxelGrid, MatchesTheCpu) {
  VoxelGridStage grid(device());
  unsigned seed = 0;
  for (const glm::ivec3 dims : {glm::ivec3(13, 9, 11), glm::ivec3(1, 17, 5), glm::ivec3(20, 1, 1),
                                glm::ivec3(1, 1, 40), glm::ivec3(1, 1, 1), glm::ivec3(48, 40, 33)})
    for (const int count : {1, 400, 5000}) {
      SCOPED_TRACE(::testing::Message() << dims.x << " x " << dims.y << " x " << dims.z << ", " << count);
      expectAsOnTheCpu(grid, cellSoup(count, dims, ++seed));
    }
  expectAsOnTheCpu(grid, cellSoup(200, {16, 16, 16}, 9), CellLattice{{9, 7, 5}, {-3.25, 0.5, 1.0}, 2.0});
}

TEST_F(VulkanVoxelGrid, MatchesTheCpuOnRegularMeshes) {
  VoxelGridStage grid(device());
  expectAsOnTheCpu(grid, onGrid(shapes::box({0, 0, 0}, {3, 1, 2}), {.resolution = 24}));
  expectAsOnTheCpu(grid, onGrid(shapes::sphere(1.0, 4), {.resolution = 40}));
  expectAsOnTheCpu(
      grid, onGrid(shapes::sphere(0.02, 4), {.resolution = 8, .box = Box{glm::dvec3(-1), glm::dvec3(1)}}));
  expectAsOnTheCpu(grid, onGrid(shapes::torus(1.0, 0.3, 60, 30),
                                {.resolution = 20, .box = Box{glm::dvec3(2.0), glm::dvec3(3.0)}}));
  expectAsOnTheCpu(grid, onGrid(shapes::torus(1.0, 0.3, 60, 30),
                                {.resolution = 20, .box = Box{glm::dvec3(-0.4), glm::dvec3(0.9)}}));
}

TEST_F(VulkanVoxelGrid, MatchesTheCpuOnSliversSegmentsAndPoints) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(-2.0f, 12.0f);
  OwnCellMesh mesh = cellSoup(300, {10, 10, 10}, 8);
  for (size_t t = 0; t < 300; ++t) {
    const glm::vec3 a = mesh.corner(t, 0), far(at(random), at(random), at(random));
    glm::vec3* v = mesh.vertices.data() + 3 * t;
    v[1] = t % 3 == 0 ? a : far;
    v[2] = t % 3 == 1 ? a + 0.25f * (far - a) : t % 3 == 2 ? 0.5f * (a + far) + 1e-4f : a;
    if (t % 4 == 0)
      for (int c = 0; c < 3; ++c) v[c] = glm::round(2.0f * v[c]) / 2.0f;  // On faces and centres of cells.
    if (t % 25 == 0) v[2] = v[2] * 1e30f;
    if (t % 40 == 0) std::copy_n(v, 3, mesh.vertices.data());  // The same triangle twice.
  }
  VoxelGridStage grid(device());
  expectAsOnTheCpu(grid, mesh, CellLattice{mesh.dims, glm::dvec3(0.0), 1.0});
}

TEST_F(VulkanVoxelGrid, IsEmptyForTrianglesFarAway) {
  OwnCellMesh mesh = cellSoup(100, {10, 10, 10}, 8);
  for (glm::vec3& v : mesh.vertices) v += glm::vec3(1e5f, -3.0f, 2e20f);
  VoxelGridStage grid(device());
  expectAsOnTheCpu(grid, mesh, CellLattice{mesh.dims, glm::dvec3(0.0), 1.0});
  EXPECT_EQ(CellStages::probe().sizes(grid).entries, 0u);
}

TEST_F(VulkanVoxelGrid, GrowsItsListsForLargeTriangles) {
  const OwnCellMesh small = cellSoup(2, {8, 400, 400}, 1);
  OwnCellMesh large = cellSoup(2, {8, 400, 400}, 2);
  const glm::vec3 corners[6] = {{1, -900, -900}, {3, 900, -900}, {2, 0, 900},
                                {6, -900, 0},    {6, 900, -900}, {5, 900, 900}};
  std::copy_n(corners, 6, large.vertices.data());
  const CellLattice cells{large.dims, glm::dvec3(0.0), 1.0};
  VoxelGridStage grid(device());
  const UploadedMesh few = CellStages::probe().upload(small), many = CellStages::probe().upload(large);
  const auto runs = [&](const UploadedMesh& mesh) {
    return CellStages::probe().runUntilItFits(
        grid, [&](const ListSizes& lists) { grid.reserve(cells, 2, lists); },
        [&](Commands& commands) { grid.record(commands, mesh.addresses()); });
  };
  EXPECT_EQ(runs(few), 1);
  EXPECT_GT(runs(many), 1);
  EXPECT_TRUE(areSame(CellStages::probe().toLists(grid), onTheCpu(large, cells)));
  EXPECT_EQ(runs(few), 1);
  EXPECT_TRUE(areSame(CellStages::probe().toLists(grid), onTheCpu(small, cells)));
}

TEST_F(VulkanVoxelGrid, RefusesMoreEntriesThanCanBeNumbered) {
  // 1000 triangles, each across all of 2000 x 2000 rows of one cell.
  OwnCellMesh mesh = cellSoup(1000, {1, 2000, 2000}, 1);
  for (size_t t = 0; t < 1000; ++t) {
    glm::vec3* v = mesh.vertices.data() + 3 * t;
    v[0] = {0, -9e3f, -9e3f}, v[1] = {0, 9e3f, -9e3f}, v[2] = {0, 0, 9e3f};
  }
  VoxelGridStage grid(device());
  const UploadedMesh uploaded = CellStages::probe().upload(mesh);
  const CellLattice cells{mesh.dims, glm::dvec3(0.0), 1.0};
  grid.reserve(cells, 1000);
  run([&](Commands& commands) { grid.record(commands, uploaded.addresses()); });
  EXPECT_FALSE(grid.fits(CellStages::probe().sizes(grid)));
  try {
    grid.reserve(cells, 1000, CellStages::probe().sizes(grid));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Memory) << error.what();
  }
}

}  // namespace
}  // namespace raymap::vulkan
