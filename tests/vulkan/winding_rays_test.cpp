#include <raymap/io.h>

#include <algorithm>

#include "mesh_folder.h"
#include "shapes.h"
#include "sign_scene.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

void expectTwins(const Mesh& mesh, const Grid& grid) {
  const CellMesh cells = cellMesh(mesh, grid);
  for (const SignMode mode : {SignMode::Rays, SignMode::Ray})
    compareRays(VulkanTest::kept<SignProbe>(), cells, mode);
}

Grid unitGrid(glm::ivec3 dims) {
  return {.dims = dims, .origin = glm::dvec3(0.0), .spacing = 1.0};
}

class VulkanWindingRays : public VulkanTest {};

TEST_F(VulkanWindingRays, Soups) {
  const Mesh mesh = shapes::soup(300, 5);
  for (const int resolution : {1, 3, 16, 40}) expectTwins(mesh, fitGrid(mesh, {.resolution = resolution}));
}

TEST_F(VulkanWindingRays, BoxesAndVoxelsOnSamplesAndLatticeLines) {
  expectTwins(shapes::box({2, 3, 4}, {9, 8, 7}), unitGrid({12, 11, 13}));
  expectTwins(shapes::box({2.5, 3, 4.5}, {9, 8.5, 7}), unitGrid({12, 11, 13}));
  expectTwins(shapes::box({0, 0, 0}, {11, 10, 12}), unitGrid({12, 11, 13}));
  expectTwins(shapes::voxels({{1, 1, 1}, {2, 2, 2}, {3, 1, 2}}, 3), unitGrid({14, 12, 13}));
}

TEST_F(VulkanWindingRays, SlantedFacesThroughSamples) {
  // A box rotated by 45 degrees about each axis has planes through samples in every way.
  for (int axis = 0; axis < 3; ++axis) {
    Mesh mesh = shapes::box({1, 1, 1}, {5, 5, 5});
    const LineAxes across(axis);
    for (glm::vec3& p : mesh.vertices) {
      const float u = p[across.u], v = p[across.v];
      p[across.u] = u - v;
      p[across.v] = u + v;
    }
    mesh.origin = glm::dvec3(6, 6, 6);
    expectTwins(mesh, unitGrid({13, 14, 15}));
  }
}

TEST_F(VulkanWindingRays, RoundShapesAndWhatTheGridCuts) {
  expectTwins(shapes::torus(1.0, 0.4, 40, 20),
              {.dims = {30, 17, 9}, .origin = {-1.4, -0.8, -0.3}, .spacing = 0.1});
  const Mesh ball = shapes::sphere(4.0, 3, {6, 6, 6});
  expectTwins(shapes::joined(ball, shapes::sphere(2.0, 2, {6, 6, 6})), unitGrid({12, 13, 14}));
  expectTwins(shapes::sphere(50.0, 3, {20, 4, 5}), unitGrid({5, 6, 7}));
}

TEST_F(VulkanWindingRays, TrianglesOfAllSizes) {
  // Extents of a few cells, of more than 2^10 and of more than 2^20 cells: three arithmetic ranges.
  for (const double size : {0.01, 3.3, 70.1, 3000.7, 5e6, 3e9, 5e11}) {
    const glm::dvec3 low(-0.37 * size, -0.41 * size, -0.53 * size);
    expectTwins(shapes::box(low, low + glm::dvec3(size)), unitGrid({41, 34, 37}));
    expectTwins(shapes::sphere(size, 1, {1, 2, 3}), unitGrid({7, 66, 5}));
  }
  Mesh soup = shapes::soup(100, 3);
  for (size_t v = 0; v < soup.vertices.size(); ++v)
    soup.vertices[v] = (soup.vertices[v] - 0.5f) * std::pow(2.0f, float(v % 38)) + 16.0f;
  expectTwins(soup, unitGrid({33, 32, 31}));
}

TEST_F(VulkanWindingRays, DegenerateAndDuplicateTriangles) {
  const std::vector<glm::dvec3> p{{1, 1, 1}, {3, 3, 3}, {5, 5, 5}, {2, 5, 3.5}, {-40, 2.5, 3}, {50, 3.25, 3}};
  expectTwins(
      makeMesh(p, {{0, 1, 2}, {0, 0, 3}, {4, 4, 4}, {0, 2, 3}, {0, 2, 3}, {2, 0, 3}, {4, 5, 3}, {5, 4, 0}}),
      unitGrid({7, 7, 7}));
  expectTwins(makeMesh(p, {{0, 2, 3}}), unitGrid({1, 1, 1}));
}

TEST_F(VulkanWindingRays, ThinAndLongGrids) {
  const Mesh open = shapes::soup(200, 4);
  for (const glm::ivec3 dims : {glm::ivec3(1, 1, 1), glm::ivec3(1, 9, 9), glm::ivec3(9, 1, 2),
                                glm::ivec3(2, 2, 9), glm::ivec3(1, 1, 70), glm::ivec3(15, 16, 17)})
    expectTwins(open, {.dims = dims, .origin = glm::dvec3(0.05), .spacing = 0.1});
  // More samples along each axis than a loop may have iterations.
  for (int axis = 0; axis < 3; ++axis) {
    glm::ivec3 dims(1, 1, 1);
    dims[axis] = 140001;
    dims[(axis + 1) % 3] = 2;
    Mesh mesh = open;
    for (glm::vec3& v : mesh.vertices) v[axis] *= 70000.0f;
    expectTwins(mesh, {.dims = dims, .origin = glm::dvec3(0.0), .spacing = 0.5});
  }
}

TEST_F(VulkanWindingRays, ManyTrianglesWithManyRuns) {
  const Mesh mesh = shapes::soup(20000, 7);
  expectTwins(mesh, fitGrid(mesh, {.resolution = 48}));
}

void expectRefusal(const Mesh& mesh, const glm::ivec3& dims, ErrorCode code, const char* reason) {
  try {
    VulkanTest::kept<SignProbe>().countCrossings(cellMesh(mesh, unitGrid(dims)));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code);
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

TEST_F(VulkanWindingRays, RefusesWhatItCannotCount) {
  // Each triangle covers 2^20 lines along z in 2^15 runs. All together have those of one triangle more than
  // 2^32.
  const Mesh many = makeMesh(std::vector<glm::dvec3>{{-9, -9, 0.4}, {3000, -9, 0.4}, {-9, 3000, 0.4}},
                             std::vector<glm::uvec3>((1u << 17) + 1, {0, 1, 2}));
  expectRefusal(many, {1024, 1024, 1}, ErrorCode::Unsupported, "4295000064");
  const Mesh far = makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {1e30, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  expectRefusal(far, {4, 4, 4}, ErrorCode::Input, "triangle 0");
}

TEST_F(VulkanWindingRays, MeshesOfAllKinds) {
  const std::filesystem::path meshes = meshFolder();
  RAYMAP_NEED_MESHES();
  for (const char* name :
       {"pymesh__tet.obj", "common3d__spot.obj", "libigl__bunny.off", "prusaslicer__M3x10_screw.stl",
        "common3d__teapot.obj", "common3d__beetle.obj", "bff__inverted_triangles.obj", "meshlab__conrod.stl",
        "admesh__hourglass.stl", "geomcentral__moebius.obj", "trimesh__soup.stl", "libigl__planexy.off",
        "libigltest__sliver_tet.ply", "openscad__issue1580-zero-area-triangle.stl"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = readMesh(meshes / name);
    expectTwins(mesh, fitGrid(mesh, {.resolution = 40}));
  }
}

}  // namespace
}  // namespace raymap::vulkan
