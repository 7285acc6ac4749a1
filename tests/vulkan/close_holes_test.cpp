#include "vulkan/stages/close_holes.h"

#include <random>

#include "cpu/distance/exact_distance.h"
#include "cpu/sign/close_holes.h"
#include "shapes.h"
#include "sign_scene.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanCloseHoles : public VulkanTest {
 protected:
  struct Uploaded {
    DeviceBuffer vertices, triangles;
    DeviceMesh mesh;
  };
  static Uploaded uploadMesh(const CellMesh& mesh) {
    Uploaded uploaded{
        .vertices = upload(std::vector<glm::vec3>(mesh.vertices.begin(), mesh.vertices.end()), "vertices"),
        .triangles =
            upload(std::vector<glm::uvec3>(mesh.triangles.begin(), mesh.triangles.end()), "triangles"),
        .mesh = {}};
    uploaded.mesh = {uploaded.vertices.address(), uploaded.triangles.address(),
                     static_cast<uint32_t>(mesh.vertices.size()),
                     static_cast<uint32_t>(mesh.triangles.size())};
    return uploaded;
  }

  /// Kept from one test to the next.
  static CloseHolesStage& stage() {
    shared();  // The device is made before the stage, so it is destroyed after it.
    static CloseHolesStage stage(device());
    return stage;
  }

  static std::vector<MissingEdge> search(const CellMesh& mesh, const Buffer<float>& winding,
                                         double threshold) {
    const Uploaded uploaded = uploadMesh(mesh);
    const DeviceBuffer numbers = upload(std::vector<float>(winding.begin(), winding.end()), "winding");
    static CrossingsStage crossings(device());
    crossings.reserve(mesh.dims, mesh.triangles.size(), true);
    do
      run([&](Commands& commands) {
        crossings.record(commands, uploaded.mesh);
        stage().recordSearch(commands, mesh.dims, crossings.crossed(), numbers.address(), threshold);
      });
    while (stage().growIfFull());
    return stage().edges();
  }

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
      const CellMesh cells = cellMesh(mesh, grid);
      Buffer<float> winding(grid.sampleCount());
      for (float& w : winding) w = anything(random);
      const std::vector<MissingEdge> expected =
          findMissingEdges(rayMapOf(mesh, grid), winding, 0.6, progress_);
      const std::vector<MissingEdge> found = search(cells, winding, 0.6);
      ASSERT_EQ(found.size(), expected.size());
      for (size_t e = 0; e < found.size(); ++e) {
        ASSERT_EQ(found[e].first, expected[e].first) << e;
        ASSERT_EQ(found[e].axis, expected[e].axis) << e;
        ASSERT_EQ(found[e].rimCubes, expected[e].rimCubes) << e;
        ASSERT_EQ(found[e].winding[0], expected[e].winding[0]) << e;
        ASSERT_EQ(found[e].winding[1], expected[e].winding[1]) << e;
      }
    }
}

TEST_F(VulkanCloseHoles, ComputesTheWindingNumberAtAnyPoint) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> along(0.0f, 15.0f);
  for (const Mesh& mesh : {shapes::soup(1, 3), shapes::soup(9, 5), tornTorus()}) {
    const Grid grid = fitGrid(mesh, {.resolution = 16});
    const Uploaded uploaded = uploadMesh(cellMesh(mesh, grid));
    std::vector<glm::vec3> points(150);
    for (glm::vec3& p : points) p = {along(random), along(random), along(random)};
    SurfaceTreeStage tree(device());
    WindingDipolesStage dipoles(device());
    tree.reserve(uploaded.mesh.triangleCount);
    dipoles.reserve(uploaded.mesh.triangleCount, grid.dims);
    run([&](Commands& commands) {
      tree.record(commands, uploaded.mesh, grid.dims);
      stage().recordNumbersAt(commands, dipoles, tree, points, 0.5);
    });
    const std::vector<float> numbers = stage().numbers();
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
    const DeviceBuffer distances = upload(std::vector<float>(expected.begin(), expected.end()), "distance");
    const DeviceBuffer triangles =
        upload(std::vector<uint32_t>(triangle.begin(), triangle.end()), "triangle");
    const CellMesh cells = cellMesh(patch, grid);
    patchTree.build(cells);
    addExactDistance(patchTree, dims, progress_, expected, &triangle);
    HolePatch onHost;
    onHost.triangles.assign(patch.triangles.begin(), patch.triangles.end());
    onHost.mesh = cellMesh(patch, grid);
    run([&](Commands& commands) {
      stage().recordDistance(commands, onHost, {distances.address(), triangles.address()});
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
