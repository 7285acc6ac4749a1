#include "vulkan/stages/winding_dipoles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "broken_meshes.h"
#include "sign_scene.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

constexpr double kThreshold = 0.5;

class VulkanWindingDipoles : public VulkanTest {
 protected:
  /// Settles samples that all start from a winding number.
  static std::vector<float> settle(const Mesh& mesh, const Grid& grid, const DipoleStart& start = {},
                                   float winding = 0.5f) {
    return settle(dipoles(), mesh, grid, std::vector<float>(grid.sampleCount(), winding), start);
  }

  static std::vector<float> settle(WindingDipolesStage& stage, const Mesh& mesh, const Grid& grid,
                                   const std::vector<float>& windings, const DipoleStart& start = {}) {
    return kept<SurfaceProbe>().settle(stage, cellMesh(mesh, grid), windings, start);
  }

  static std::vector<float> numbersAt(WindingDipolesStage& stage, const Mesh& mesh, const Grid& grid,
                                      const std::vector<glm::vec3>& points) {
    const DeviceBuffer at = upload(points, "points");
    const DeviceBuffer numbers = upload(std::vector<float>(points.size()), "numbers");
    stage.reserve(static_cast<uint32_t>(mesh.triangles.size()), grid.dims);
    kept<SurfaceProbe>().runWithTree(
        cellMesh(mesh, grid), [&](Commands& commands, const SurfaceTreeStage& tree) {
          stage.recordNumbersAt(commands, tree, at.address(), static_cast<uint32_t>(points.size()),
                                numbers.address(), kThreshold);
        });
    return download<float>(numbers);
  }

  static WindingDipolesStage& dipoles() { return kept<WindingDipolesStage>(); }
};

Mesh openSphere(int subdivisions = 4) {
  return withoutCap(shapes::sphere(1.0, subdivisions), 0.4);
}

TEST_F(VulkanWindingDipoles, AreTheSumOfTheSolidAngles) {
  // One triangle, a leaf that is not full, one triangle more than a leaf holds, and thousands.
  for (const Mesh& mesh :
       {shapes::soup(1, 3), shapes::soup(5, 4), shapes::soup(9, 5), shapes::soup(1000, 6), openSphere()})
    checkSettled(kept<SurfaceProbe>(), dipoles(), onGrid(mesh, {.resolution = 16}));
}

/// Sizes of groups: one subgroup or several, on any device.
constexpr uint32_t kGroups[] = {8, 16, 64, 256};

TEST_F(VulkanWindingDipoles, AreTheSameForAnySizeOfGroups) {
  for (const Mesh& mesh : {shapes::soup(5, 4), shapes::soup(1000, 6), openSphere()}) {
    const Grid grid = fitGrid(mesh, {.resolution = 8});
    const std::vector<float> expected = settle(mesh, grid);
    for (const uint32_t group : kGroups) {
      WindingDipolesStage stage(device(), nullptr, group);
      EXPECT_EQ(settle(stage, mesh, grid, std::vector<float>(grid.sampleCount(), 0.5f)), expected) << group;
    }
  }
}

TEST_F(VulkanWindingDipoles, LeaveNoDoubtfulSampleOutWhereTheListIsFull) {
  const Mesh mesh = shapes::soup(40, 6);  // Short work: the checks of every access can follow it.
  Grid grid = fitGrid(mesh, {.resolution = 11});
  grid.dims = {11, 9, 9};  // Not a multiple of 8 samples.
  const size_t count = grid.sampleCount(), capacity = (count + kSamplesPerListed - 1) / kSamplesPerListed;
  const std::vector<float> all = settle(mesh, grid);
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  for (const size_t doubtful : {size_t{1}, capacity, capacity + 1, count - 1}) {
    std::vector<float> windings(count, 0.9f), expected(count, 0.9f);
    for (size_t i = 0; i < doubtful; ++i) {
      windings[order[i]] = 0.5f;
      expected[order[i]] = all[order[i]];
    }
    EXPECT_EQ(settle(dipoles(), mesh, grid, windings), expected) << doubtful << " of " << capacity;
  }
}

TEST_F(VulkanWindingDipoles, CountEveryTriangleOfADeepTree) {
  // All triangles are equal, so every node of the tree is opened. Their number is far above 1.
  Mesh mesh = shapes::soup(1, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  const glm::vec3 point(7, 8, 7);
  const double one = reference::windingNumber(mesh, grid.position(glm::dvec3(point)));
  ASSERT_GT(std::abs(one), 0.01);
  mesh.triangles.resize(30000, mesh.triangles.front());
  const std::vector<float> expected = numbersAt(dipoles(), mesh, grid, {point});
  EXPECT_NEAR(expected.front(), 30000 * one, 30000 * 1e-6);
  for (const uint32_t group : kGroups) {
    WindingDipolesStage stage(device(), nullptr, group);
    EXPECT_EQ(numbersAt(stage, mesh, grid, {point}), expected) << group;
  }
}

TEST_F(VulkanWindingDipoles, HaveAStackForTheLargestTree) {
  EXPECT_EQ(SurfaceTreeStage::placeLevels(1u << 29).size(), kMostTreeLevels);
}

TEST_F(VulkanWindingDipoles, LeaveAloneWhatIsFarFromTheThreshold) {
  const Mesh mesh = openSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 12});
  // The lattice's error is smaller far from the surface.
  for (const auto& [winding, distance] : {std::pair(0.85f, 0.0f), {-0.15f, 0.0f}, {0.55f, 20.0f}})
    for (const float w : settle(mesh, grid, {.distance = distance}, winding)) ASSERT_EQ(w, winding);
}

TEST_F(VulkanWindingDipoles, DoubtMoreWhereTheFieldCannotFollowTheCrossings) {
  const Mesh mesh = openSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 12});
  // The doubt of 0.04 is 1.5 and 0.9 times as large.
  for (const float w : settle(mesh, grid, {.distance = 20.0f, .change = 0.5f}, 0.55f)) ASSERT_NE(w, 0.55f);
  for (const float w : settle(mesh, grid, {.distance = 20.0f, .change = 0.3f}, 0.545f)) ASSERT_EQ(w, 0.545f);
}

TEST_F(VulkanWindingDipoles, LeaveToTheRimsWhatTheLastLookIsNotSureOf) {
  const Mesh mesh = openSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 12});
  const std::vector<float> twice = settle(mesh, grid, {.distance = 1.0f, .looks = {.most = 2}});
  size_t unsure = 0;
  const std::vector<float> left = settle(mesh, grid, {.distance = 1.0f, .looks = {2, true}});
  for (size_t s = 0; s < twice.size(); ++s) {
    const float gap = std::abs(std::abs(twice[s]) - 0.5f);
    ASSERT_TRUE(gap >= kClose[1] || left[s] == 0.5f) << s;
    if (left[s] == 0.5f)
      ++unsure;
    else
      ASSERT_EQ(left[s], twice[s]) << s;
  }
  EXPECT_GT(unsure, 0u);
  EXPECT_LT(unsure, twice.size() / 20);
  // On the surface, no look is sure. Short work: the checks of every access can follow it.
  const Mesh coarse = openSphere(2);
  for (const float w : settle(coarse, grid, {.distance = kOnSurface, .looks = {kLooks, true}}))
    ASSERT_EQ(w, 0.5f);
  for (const float w : settle(coarse, grid, {.distance = kOnSurface})) ASSERT_NE(w, 0.5f);
}

TEST_F(VulkanWindingDipoles, LeaveEverythingWhereAllRaysAgree) {
  const Mesh mesh = openSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 12});
  for (const float w : settle(mesh, grid, {.disagreeing = 0})) ASSERT_EQ(w, 0.5f);
}

TEST_F(VulkanWindingDipoles, SurviveDegenerateTriangles) {
  Mesh mesh = openSphere();
  mesh.triangles.insert(mesh.triangles.begin(), {{0, 0, 0}, {0, 1, 1}, {2, 3, 2}});
  for (const float w : settle(mesh, fitGrid(mesh, {.resolution = 16}))) ASSERT_TRUE(std::abs(w) < 1.1f);
}

}  // namespace
}  // namespace raymap::vulkan
