#include "vulkan/stages/cell_mesh.h"

#include "shapes.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanCellMesh : public VulkanTest {
 protected:
  static void record(CellMeshStage& cells, const Mesh& mesh, const Grid& grid, double outside = 0.0) {
    MeshUpload upload(device());
    upload.fill(mesh);
    cells.reserve(upload.source().vertexCount, upload.source().triangleCount);
    run([&](Commands& commands) { cells.record(commands, upload.source(), grid, outside); });
  }
};

TEST_F(VulkanCellMesh, CountsTrianglesOutside) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  CellMeshStage cells(device());
  const auto outside = [&](const Grid& grid, double reach) {
    record(cells, mesh, grid, reach);
    const auto status = download<CellMeshStatus>(cells.status()).at(0);
    EXPECT_EQ(status.bad, 0u);
    EXPECT_EQ(~status.firstGood, 0u);
    return status.outside;
  };
  const Grid inner{.dims = {4, 4, 4}, .origin = glm::dvec3(0.125), .spacing = 0.25};
  EXPECT_EQ(outside(inner, 0.0), 0u);
  const Grid moved{.dims = {4, 4, 4}, .origin = {0.625, 0.125, 0.125}, .spacing = 0.25};
  EXPECT_EQ(outside(moved, 0.0), 10u) << "all but the face at x = 1";
  EXPECT_EQ(outside(moved, 1.9), 10u);
  EXPECT_EQ(outside(moved, 2.0), 0u);
}

TEST_F(VulkanCellMesh, CollapsesInvalidTrianglesOntoValidOnes) {
  Mesh mesh = shapes::sphere(1.0, 3);
  const std::vector<glm::uvec3> before = mesh.triangles;
  const auto vertices = static_cast<uint32_t>(mesh.vertices.size());
  const auto add = [&](float x) {
    mesh.vertices.emplace_back(x, 0.0f, 0.0f);
    return static_cast<uint32_t>(mesh.vertices.size() - 1);
  };
  mesh.triangles[0] = {add(NAN), 1, 2};
  mesh.triangles[7] = {1, add(-INFINITY), 2};
  mesh.triangles[8] = {1, 2, vertices + 100};
  mesh.triangles[9] = {1, UINT32_MAX, 2};
  mesh.triangles.back() = {1, add(3e38f), 2};  // Infinite in cells.
  CellMeshStage cells(device());
  record(cells, mesh, {.dims = {4, 4, 4}, .spacing = 0.1});
  const auto status = download<CellMeshStatus>(cells.status()).at(0);
  EXPECT_EQ(status.bad, 3u + 5u);
  EXPECT_EQ(status.badTriangles, 5u);
  EXPECT_EQ(~status.firstBad, 0u);
  EXPECT_EQ(~status.firstGood, 1u);
  const auto triangles = download<glm::uvec3>(cells.triangleBuffer());
  for (size_t t = 0; t < triangles.size(); ++t)
    ASSERT_EQ(triangles[t], mesh.triangles[t] == before[t] ? before[t] : glm::uvec3(before[1].x)) << t;
  for (const float x : download<float>(cells.vertexBuffer())) ASSERT_TRUE(std::isfinite(x));
}

TEST_F(VulkanCellMesh, SurvivesAMeshOfInvalidTriangles) {
  Mesh mesh = shapes::sphere(1.0, 1);
  for (glm::uvec3& t : mesh.triangles) t.y = UINT32_MAX;
  CellMeshStage cells(device());
  record(cells, mesh, {.dims = {4, 4, 4}, .spacing = 0.1});
  EXPECT_EQ(download<CellMeshStatus>(cells.status()).at(0).badTriangles, mesh.triangles.size());
  for (const glm::uvec3& t : download<glm::uvec3>(cells.triangleBuffer())) ASSERT_EQ(t, glm::uvec3(0));
}

}  // namespace
}  // namespace raymap::vulkan
