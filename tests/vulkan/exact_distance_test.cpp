#include "vulkan/stages/exact_distance.h"

#include <raymap/io.h>

#include <cmath>
#include <map>
#include <tuple>

#include "exact_cases.h"
#include "mesh_folder.h"
#include "shaders/uneven_barriers.h"
#include "shaders/uneven_barriers_spv.h"
#include "vulkan/device/kernel.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

constexpr double kAllowed = 1e-6;  // of the diagonal of the bounds

class VulkanExactDistance : public VulkanTest {
 protected:
  struct Found {
    std::vector<float> distance;
    std::vector<uint32_t> triangle;
    bool operator==(const Found&) const = default;
  };

  using Imitated = ExactDistanceStage::Imitated;

  struct Stages {
    explicit Stages(const Imitated& imitated)
        : tree(device(), imitated.rootError), exact(device(), nullptr, imitated) {}
    SurfaceTreeStage tree;
    ExactDistanceStage exact;
  };
  static Stages& stagesLike(const Imitated& imitated) {
    static std::map<std::tuple<uint32_t, int32_t, uint32_t>, Stages> stages;
    return stages.try_emplace({imitated.subgroups, imitated.rootError, imitated.mostWork}, imitated)
        .first->second;
  }

  /// Distances in the mesh's units.
  static Found find(const Mesh& mesh, const Grid& grid, double band = 0.0, const Imitated& imitated = {}) {
    std::vector<glm::vec3> cells;
    for (const glm::vec3& v : mesh.vertices)
      cells.emplace_back((mesh.origin - grid.origin + glm::dvec3(v)) / grid.spacing);
    Found found = findInCells(cells, mesh.triangles, grid.dims, band, imitated);
    for (float& d : found.distance) d *= static_cast<float>(grid.spacing);
    return found;
  }

  /// Computes the distances twice.
  static Found findInCells(const std::vector<glm::vec3>& vertices, const std::vector<glm::uvec3>& triangles,
                           const glm::ivec3& dims, double band = 0.0, const Imitated& imitated = {}) {
    const DeviceBuffer vertexBuffer = upload(vertices, "vertices"),
                       triangleBuffer = upload(triangles, "triangles");
    const DeviceMesh mesh{vertexBuffer.address(), triangleBuffer.address(),
                          static_cast<uint32_t>(vertices.size()), static_cast<uint32_t>(triangles.size())};
    DeviceBuffer distance(device(), "distance"), triangle(device(), "triangle");
    const size_t samples = size_t(dims.x) * dims.y * dims.z;
    distance.resize<float>(samples);
    triangle.resize<uint32_t>(samples);
    Stages& stages = stagesLike(imitated);
    SurfaceTreeStage& tree = stages.tree;
    ExactDistanceStage& exact = stages.exact;
    tree.reserve(mesh.triangleCount);
    exact.reserve(dims);
    Found found[2];
    for (Found& f : found) {
      run([&](Commands& commands) {
        tree.record(commands, mesh, dims);
        exact.record(commands, tree, band, {distance.address(), triangle.address()});
      });
      f = {download<float>(distance), download<uint32_t>(triangle)};
    }
    EXPECT_TRUE(found[0] == found[1]) << "the second time";
    return found[0];
  }
};

TEST_F(VulkanExactDistance, IsExact) {
  for (const ExactCase& c : exactCases(24)) {
    const Found found = find(c.mesh, c.grid);
    EXPECT_LT(largestExactError(c.mesh, c.grid, found.distance, found.triangle, 300), kAllowed) << c.name;
  }
}

TEST_F(VulkanExactDistance, IsExactWhereRootsAreInexact) {
  for (const int32_t rootError : {-3, 3})
    for (const ExactCase& c : exactCases(24)) {
      const Found found = find(c.mesh, c.grid, 0.0, {.rootError = rootError});
      EXPECT_LT(largestExactError(c.mesh, c.grid, found.distance, found.triangle, 300), kAllowed) << c.name;
    }
}

TEST_F(VulkanExactDistance, IsExactOnThinGrids) {
  const Mesh mesh = shapes::torus(7.0, 2.0, 60, 30);
  for (const glm::ivec3& dims :
       {glm::ivec3(1, 1, 1), glm::ivec3(1, 1, 50), glm::ivec3(37, 1, 2), glm::ivec3(2, 17, 1)}) {
    const Grid grid{dims, glm::dvec3(-3.0), 0.3};
    const Found found = find(mesh, grid);
    EXPECT_LT(largestExactError(mesh, grid, found.distance, found.triangle, 50), kAllowed) << dims.x;
  }
}

TEST_F(VulkanExactDistance, StopsAtTheBand) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 40, 20);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  const Found all = find(mesh, grid);
  for (const double band : {0.5, 3.0, 1000.0}) {
    const Found found = find(mesh, grid, band);
    const float limit = static_cast<float>(band) * static_cast<float>(grid.spacing);
    size_t beyond = 0;
    for (size_t s = 0; s < all.distance.size(); ++s) {
      const bool isBeyond = all.distance[s] > limit;
      beyond += isBeyond;
      ASSERT_NEAR(found.distance[s], isBeyond ? limit : all.distance[s], 1e-6) << s;
      if (std::abs(all.distance[s] - limit) > 1e-6) {
        ASSERT_EQ(found.triangle[s] == kNoTriangle, isBeyond) << s;
      }
    }
    EXPECT_EQ(beyond > 0, band < 100.0);
  }
}

TEST_F(VulkanExactDistance, VisitsEveryTriangleWhereItMust) {
  // The discs of triangles across the whole box exclude none of them, and there are more than a loop may
  // visit.
  const Mesh mesh = shapes::soup(100000, 5);
  const Grid grid{glm::ivec3(5, 3, 1), glm::dvec3(2.0, 0.3, 0.4), 0.3};
  const Found found = find(mesh, grid);
  EXPECT_LT(largestExactError(mesh, grid, found.distance, found.triangle, 40), kAllowed);
}

TEST_F(VulkanExactDistance, FinishesBlocksForTheirFarthestSample) {
  // Large triangles below the block, tilted about one point, are too much work. The small triangle in the
  // last leaf is closest to one corner of the block only, and the lanes beyond that leaf hold this corner.
  constexpr size_t kLarge = 8 * 8 * 500;
  std::mt19937 random(11);
  std::uniform_real_distribution<float> slope(-0.01f, 0.01f);
  std::vector<glm::vec3> vertices;
  for (size_t t = 0; t < kLarge; ++t) {
    const float alongX = slope(random), alongZ = slope(random);
    for (const glm::vec2& xz : {glm::vec2(-30, -30), glm::vec2(60, -30), glm::vec2(-30, 60)})
      vertices.emplace_back(xz.x, alongX * (xz.x - 1.5f) + alongZ * (xz.y - 1.5f) - 1.0f, xz.y);
  }
  const glm::vec3 corner(3.0f + 3.5f / std::sqrt(3.0f));
  for (const glm::vec3& offset : {glm::vec3(0.0f), glm::vec3(0.01f, 0, 0), glm::vec3(0, 0, 0.01f)})
    vertices.push_back(corner + offset);
  std::vector<glm::uvec3> triangles;
  for (uint32_t v = 0; v < vertices.size(); v += 3) triangles.emplace_back(v, v + 1, v + 2);
  const Found found = findInCells(vertices, triangles, {4, 4, 4});
  EXPECT_NEAR(found.distance.back(), 3.5, 1e-5);
  EXPECT_EQ(found.triangle.back(), kLarge);
}

TEST_F(VulkanExactDistance, TakesOneOfManyEqualTriangles) {
  const std::vector<glm::dvec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Mesh one = makeMesh(corners, {{0, 1, 2}});
  const Mesh many = makeMesh(corners, std::vector<glm::uvec3>(100000, {0, 1, 2}));
  const Grid grid{glm::ivec3(5, 3, 2), glm::dvec3(-0.9, -0.8, 0.4), 0.25};
  EXPECT_EQ(find(one, grid).distance, find(many, grid).distance);
}

TEST_F(VulkanExactDistance, SurvivesHugeCoordinates) {
  for (const float huge : {1e8f, 1e15f, 1e25f, 3e38f}) {
    const std::vector<glm::vec3> vertices{{1, 1, 1},        {3, 1, 1},       {1, 4, 1},
                                          {huge, -huge, 0}, {huge, 0, huge}, {-huge, huge, -huge}};
    const std::vector<glm::uvec3> triangles{{0, 1, 2}, {3, 4, 5}, {0, 4, 5}, {3, 3, 5}, {3, 3, 3}};
    const Found found = findInCells(vertices, triangles, {6, 5, 4});
    EXPECT_LE(found.distance[(1 * 5 + 1) * 6 + 1], 1e-6 * huge);
  }
}

/// The same with several subgroups per group. Cards work so; in software the default is one.
class VulkanExactDistanceGroups : public VulkanExactDistance, public ::testing::WithParamInterface<uint32_t> {
 protected:
  void SetUp() override {
    VulkanExactDistance::SetUp();
    if (!IsSkipped() && !HasFatalFailure() && !keepsSubgroupsApart())
      GTEST_SKIP() << "the driver takes a barrier of a subgroup for one of the group";
  }

  /// Returns whether the subgroups of a group can have different numbers of barriers.
  static bool keepsSubgroupsApart() {
    const uint32_t groupSize = GetParam() * device().limits().maxSubgroupSize;
    Kernel<UnevenBarriersPush> kernel(device(), shaders::kUnevenBarriers, groupSize);
    const size_t most = groupSize / device().limits().minSubgroupSize;
    const DeviceBuffer reached = upload(std::vector<uint32_t>(most), "reached");
    run([&](Commands& commands) {
      commands.dispatch(kernel, UnevenBarriersPush{.reached = reached.address()}, groupSize);
    });
    const std::vector<uint32_t> found = download<uint32_t>(reached);
    return std::count(found.begin(), found.end(), 1u) >= std::ptrdiff_t(GetParam());
  }
};

TEST_P(VulkanExactDistanceGroups, FindTheSameAsOneSubgroup) {
  const std::vector<std::pair<Mesh, GridOptions>> cases = {
      {shapes::sphere(1.0, 3),
       {.resolution = 24}},  // Near the middle, hundreds of triangles are equally far.
      {shapes::sphere(1.0, 5), {.resolution = 6}},
      {shapes::joined(shapes::sphere(1.0, 3), shapes::sphere(0.01, 4, {0.4, 0, 0})), {.resolution = 12}},
      {shapes::torus(1.0, 0.3, 80, 40), {.resolution = 33}},
      {shapes::soup(500, 1), {.resolution = 21}}};
  for (const auto& [mesh, options] : cases) {
    const Grid grid = fitGrid(mesh, options);
    const Found found = find(mesh, grid, 0.0, {GetParam()});
    EXPECT_LT(largestExactError(mesh, grid, found.distance, found.triangle, 300), kAllowed)
        << mesh.triangles.size();
    EXPECT_TRUE(found == find(mesh, grid, 0.0, {1})) << mesh.triangles.size();
    EXPECT_TRUE(find(mesh, grid, 2.5, {GetParam()}) == find(mesh, grid, 2.5, {1})) << mesh.triangles.size();
  }
}

TEST_P(VulkanExactDistanceGroups, FinishBlocksWithTooMuchWork) {
  const Mesh mesh = shapes::soup(20000, 5);
  const Grid grid{glm::ivec3(13, 3, 2), glm::dvec3(2.0, 0.3, 0.4), 0.3};
  const Found found = find(mesh, grid, 0.0, {GetParam()});
  EXPECT_LT(largestExactError(mesh, grid, found.distance, found.triangle, 40), kAllowed);
  EXPECT_TRUE(found == find(mesh, grid, 0.0, {1}));
}

/// The search for single samples must find what blocks find, wherever these stop.
TEST_P(VulkanExactDistanceGroups, FinishHeavyBlocksSampleBySample) {
  const std::vector<std::tuple<Mesh, GridOptions, double>> cases = {
      {shapes::sphere(1.0, 3), {.resolution = 13}, 0.0},
      {shapes::torus(1.0, 0.3, 80, 40), {.resolution = 18}, 2.5},
      {shapes::soup(2000, 2), {.resolution = 9}, 0.0}};
  for (const auto& [mesh, options, band] : cases) {
    SCOPED_TRACE(mesh.triangles.size());
    const Grid grid = fitGrid(mesh, options);
    const Found whole = find(mesh, grid, band, {GetParam()});
    for (const uint32_t mostWork : {1u, 100u}) {
      const Found alone = find(mesh, grid, band, {GetParam(), 0, mostWork});
      EXPECT_TRUE(alone == find(mesh, grid, band, {1, 0, mostWork}));
      for (size_t s = 0; s < whole.distance.size(); ++s)
        ASSERT_NEAR(whole.distance[s], alone.distance[s], 1e-6) << s << ", work " << mostWork;
      if (band > 0.0) continue;
      EXPECT_LT(largestExactError(mesh, grid, alone.distance, alone.triangle, 300), kAllowed);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Subgroups, VulkanExactDistanceGroups, ::testing::Values(1u, 2u, 4u),
                         ::testing::PrintToStringParamName());

TEST_F(VulkanExactDistance, IsExactOnRealMeshes) {
  RAYMAP_NEED_MESHES();
  for (const char* name :
       {"pymesh__tet.obj", "libigl__cube.off", "trimesh__20mm-xyz-cube.stl", "trimesh__featuretype.ply",
        "prusaslicer__M3x10_screw.stl", "libigl__bunny.off", "common3d__spot.obj", "sellan__eiffel.obj",
        "manifold__mengerSponge3.glb", "draco__bun_zipper.ply", "libigl__planexy.off",
        "meshlab__non_manif_hole.ply", "common3d__beetle.obj", "meshlab__conrod.stl",
        "stanford-drago__dragon_vrip_res4.ply"}) {
    const Mesh mesh = readMesh(meshFolder() / name);
    const Grid grid = fitGrid(mesh, {.resolution = 48});
    const Found found = find(mesh, grid);
    EXPECT_LT(largestExactError(mesh, grid, found.distance, found.triangle, 100), kAllowed) << name;
  }
}

}  // namespace
}  // namespace raymap::vulkan
