#include "vulkan/stages/exact_distance.h"

#include <raymap/io.h>

#include <cmath>
#include <map>
#include <tuple>

#include "cells.h"
#include "exact_cases.h"
#include "mesh_folder.h"
#include "shaders/uneven_barriers.h"
#include "shaders/uneven_barriers_spv.h"
#include "vulkan/device/kernel.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanExactDistance : public VulkanTest {
 protected:
  using Imitated = ExactDistanceStage::Imitated;

  static SurfaceProbe& probeLike(const Imitated& imitated) {
    static std::map<std::tuple<uint32_t, int32_t, uint32_t>, SurfaceProbe> probes;
    return probes.try_emplace({imitated.subgroups, imitated.rootError, imitated.mostWork}, device(), imitated)
        .first->second;
  }

  static void expectExact(const OwnCellMesh& mesh, float band = 3.0f, const Imitated& imitated = {},
                          double looks = 1e6) {
    checkClosest(probeLike(imitated), mesh, band, looks);
  }
};

TEST_F(VulkanExactDistance, IsExact) {
  for (const int32_t rootError : {0, -3, 3})  // Roots may be inexact.
    for (const ExactCase& c : exactCases(24))
      inCase(c.name, [&] { expectExact({c.mesh, c.grid}, 3.0f, {.rootError = rootError}); });
}

TEST_F(VulkanExactDistance, IsExactOnThinGrids) {
  const Mesh mesh = shapes::torus(7.0, 2.0, 60, 30);
  for (const glm::ivec3& dims :
       {glm::ivec3(1, 1, 1), glm::ivec3(1, 1, 50), glm::ivec3(37, 1, 2), glm::ivec3(2, 17, 1)})
    expectExact({mesh, {dims, glm::dvec3(-3.0), 0.3}});
}

TEST_F(VulkanExactDistance, StopsAtTheBand) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 40, 20);
  const OwnCellMesh cells = onGrid(mesh, {.resolution = 40});
  for (const float band : {0.5f, 3.0f, 1000.0f}) expectExact(cells, band);
}

TEST_F(VulkanExactDistance, VisitsEveryTriangleWhereItMust) {
  // The discs of triangles across the whole box exclude none of them, and there are more than a loop may
  // visit.
  expectExact({shapes::soup(100000, 5), {glm::ivec3(5, 3, 1), glm::dvec3(2.0, 0.3, 0.4), 0.3}}, 3.0f, {},
              1e7);
}

TEST_F(VulkanExactDistance, FinishesBlocksForTheirFarthestSample) {
  // Large triangles below the block, tilted about one point, are too much work. The small triangle in the
  // last leaf is closest to one corner of the block only, and the lanes beyond that leaf hold this corner.
  constexpr size_t kLarge = 8 * 8 * 500;
  std::mt19937 random(11);
  std::uniform_real_distribution<float> slope(-0.01f, 0.01f);
  Mesh mesh;
  for (size_t t = 0; t < kLarge; ++t) {
    const float alongX = slope(random), alongZ = slope(random);
    for (const glm::vec2& xz : {glm::vec2(-30, -30), glm::vec2(60, -30), glm::vec2(-30, 60)})
      mesh.vertices.emplace_back(xz.x, alongX * (xz.x - 1.5f) + alongZ * (xz.y - 1.5f) - 1.0f, xz.y);
  }
  const glm::vec3 corner(3.0f + 3.5f / std::sqrt(3.0f));
  for (const glm::vec3& offset : {glm::vec3(0.0f), glm::vec3(0.01f, 0, 0), glm::vec3(0, 0, 0.01f)})
    mesh.vertices.push_back(corner + offset);
  for (uint32_t v = 0; v < mesh.vertices.size(); v += 3) mesh.triangles.emplace_back(v, v + 1, v + 2);
  const ClosestResult found = probeLike({}).closest(inCells(mesh, {4, 4, 4}));
  EXPECT_NEAR(found.distance.back(), 3.5, 1e-5);
  EXPECT_EQ(found.triangle.back(), kLarge);
}

TEST_F(VulkanExactDistance, TakesOneOfManyEqualTriangles) {
  const std::vector<glm::dvec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Grid grid{glm::ivec3(5, 3, 2), glm::dvec3(-0.9, -0.8, 0.4), 0.25};
  const OwnCellMesh one(makeMesh(corners, {{0, 1, 2}}), grid),
      many(makeMesh(corners, std::vector<glm::uvec3>(100000, {0, 1, 2})), grid);
  EXPECT_EQ(probeLike({}).closest(one).distance, probeLike({}).closest(many).distance);
}

TEST_F(VulkanExactDistance, SurvivesHugeCoordinates) {
  for (const float huge : {1e8f, 1e15f, 1e25f, 3e38f}) {
    const Mesh mesh{
        .vertices =
            {{1, 1, 1}, {3, 1, 1}, {1, 4, 1}, {huge, -huge, 0}, {huge, 0, huge}, {-huge, huge, -huge}},
        .triangles = {{0, 1, 2}, {3, 4, 5}, {0, 4, 5}, {3, 3, 5}, {3, 3, 3}}};
    const ClosestResult found = probeLike({}).closest(inCells(mesh, {6, 5, 4}));
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
    const OwnCellMesh cells = onGrid(mesh, options);
    expectExact(cells, 2.5f, {GetParam()});
    for (const double band : {0.0, 2.5})
      EXPECT_TRUE(probeLike({GetParam()}).closest(cells, band) == probeLike({1}).closest(cells, band))
          << mesh.triangles.size();
  }
}

TEST_P(VulkanExactDistanceGroups, FinishBlocksWithTooMuchWork) {
  const OwnCellMesh cells(shapes::soup(20000, 5), {glm::ivec3(13, 3, 2), glm::dvec3(2.0, 0.3, 0.4), 0.3});
  expectExact(cells, 2.5f, {GetParam()});
  EXPECT_TRUE(probeLike({GetParam()}).closest(cells) == probeLike({1}).closest(cells));
}

/// The search for single samples must find what blocks find, wherever these stop.
TEST_P(VulkanExactDistanceGroups, FinishHeavyBlocksSampleBySample) {
  const std::vector<std::tuple<Mesh, GridOptions, double>> cases = {
      {shapes::sphere(1.0, 3), {.resolution = 13}, 0.0},
      {shapes::torus(1.0, 0.3, 80, 40), {.resolution = 18}, 2.5},
      {shapes::soup(2000, 2), {.resolution = 9}, 0.0}};
  for (const auto& [mesh, options, band] : cases)
    for (const uint32_t mostWork : {1u, 100u}) {
      const OwnCellMesh cells = onGrid(mesh, options);
      const Imitated imitated{GetParam(), 0, mostWork};
      EXPECT_TRUE(probeLike(imitated).closest(cells, band) ==
                  probeLike({1, 0, mostWork}).closest(cells, band));
      expectExact(cells, 2.5f, imitated);
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
    const double looks = 100.0 * double(mesh.triangles.size());
    inCase(name, [&] { expectExact(onGrid(mesh, {.resolution = 48}), 3.0f, {}, looks); });
  }
}

}  // namespace
}  // namespace raymap::vulkan
