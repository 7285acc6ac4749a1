#include "vulkan/stages/close_holes.h"

#include <random>

#include "cpu/distance/exact_distance.h"
#include "cpu/sign/close_holes.h"
#include "shapes.h"
#include "sign_scene.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanCloseHoles : public VulkanTest {
 protected:
  Progress progress_;
};

Mesh tornTorus() {
  Mesh mesh = shapes::torus(1.0, 0.4, 30, 16);
  mesh.triangles.erase(mesh.triangles.begin() + 40, mesh.triangles.begin() + 120);
  return mesh;
}

TEST_F(VulkanCloseHoles, FindsTheEdgesThatTheCpuFinds) {
  // Faces that cross an edge in both directions cancel in its signed count, but they do cross it.
  Mesh twice = tornTorus();
  const size_t count = twice.triangles.size();
  for (size_t t = 0; t < count; t += 2) {
    const glm::uvec3 face = twice.triangles[t];
    twice.triangles.emplace_back(face.x, face.z, face.y);
  }
  std::mt19937 random(3);
  std::uniform_real_distribution<float> anything(-1.2f, 1.2f);
  for (const Mesh& mesh : {tornTorus(), twice, shapes::soup(60, 5)})
    for (const glm::ivec3& dims : {glm::ivec3(24, 23, 12), glm::ivec3(9, 1, 30), glm::ivec3(1)}) {
      Grid grid = fitGrid(mesh, {.resolution = 24});
      grid.dims = dims;
      Buffer<float> winding(grid.sampleCount());
      for (float& w : winding) w = anything(random);
      compareMissingEdges(kept<Probe>(), kept<CloseHolesStage>(), cellMesh(mesh, grid), winding);
    }
}

TEST_F(VulkanCloseHoles, ComputesTheWindingNumberAtAnyPoint) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> along(0.0f, 15.0f);
  for (const Mesh& mesh : {shapes::soup(1, 3), shapes::soup(9, 5), tornTorus()}) {
    const Grid grid = fitGrid(mesh, {.resolution = 16});
    std::vector<glm::vec3> points(150);
    for (glm::vec3& p : points) p = {along(random), along(random), along(random)};
    WindingDipolesStage dipoles(device());
    dipoles.reserve(uint32_t(mesh.triangles.size()), grid.dims);
    kept<SurfaceProbe>().runWithTree(
        cellMesh(mesh, grid), [&](Commands& commands, const SurfaceTreeStage& tree) {
          kept<CloseHolesStage>().recordNumbersAt(commands, dipoles, tree, points, 0.5);
        });
    const std::vector<float> numbers = kept<CloseHolesStage>().numbers();
    ASSERT_EQ(numbers.size(), points.size());
    for (size_t p = 0; p < points.size(); ++p)
      ASSERT_NEAR(numbers[p], reference::windingNumber(mesh, grid.position(glm::dvec3(points[p]))), 2e-4)
          << p;
  }
}

TEST_F(VulkanCloseHoles, AddsDistancesToAPatch) {
  const Mesh mesh = shapes::soup(40, 6), patch = shapes::soup(25, 7);
  for (const glm::ivec3& dims : {glm::ivec3(30, 21, 19), glm::ivec3(1, 1, 9)}) {
    Grid grid = fitGrid(mesh, {.resolution = 30});
    grid.dims = dims;
    Buffer<float> expected(grid.sampleCount());
    Buffer<uint32_t> triangle(grid.sampleCount());
    cpu::SurfaceTree tree, patchTree;
    tree.build(cellMesh(mesh, grid));
    computeExactDistance(tree, dims, 0.0, progress_, expected, &triangle);
    const DeviceBuffer distances = upload(expected, "distance"), triangles = upload(triangle, "triangle");
    HolePatch onHost;
    onHost.triangles.assign(patch.triangles.begin(), patch.triangles.end());
    onHost.mesh = cellMesh(patch, grid);
    patchTree.build(onHost.mesh);
    addExactDistance(patchTree, dims, progress_, expected, &triangle);
    run([&](Commands& commands) {
      kept<CloseHolesStage>().recordDistance(commands, onHost, {distances.address(), triangles.address()});
    });
    const std::vector<float> found = download<float>(distances);
    const std::vector<uint32_t> ids = download<uint32_t>(triangles);
    size_t ofPatch = 0;
    for (size_t s = 0; s < found.size(); ++s) {
      ASSERT_NEAR(found[s], expected[s], 1e-5f) << s;
      ASSERT_EQ(ids[s], triangle[s]) << s;
      ofPatch += ids[s] == kNoTriangle ? 1 : 0;
    }
    EXPECT_GT(ofPatch, found.size() / 10);
    EXPECT_LT(ofPatch, found.size());
  }
}

}  // namespace
}  // namespace raymap::vulkan
