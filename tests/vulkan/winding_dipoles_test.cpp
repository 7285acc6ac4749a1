#include "vulkan/stages/winding_dipoles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "cpu/sign/winding_dipoles.h"
#include "shapes.h"
#include "sign_scene.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

constexpr double kThreshold = 0.5;

/// Values that every sample starts from.
struct Start {
  float winding = 0.5f;   ///< Winding number of the lattice.
  float distance = 0.0f;  ///< From the surface, in cells.
  uint32_t disagreeing = 1;
  float change = 0.0f;  ///< Largest of the winding number along a crossed edge.
  WindingDipolesStage::Looks looks;
};

class VulkanWindingDipoles : public VulkanTest {
 protected:
  static std::vector<float> settle(const Mesh& mesh, const Grid& grid, const Start& start) {
    return settle(dipoles(), mesh, grid, std::vector<float>(grid.sampleCount(), start.winding), start);
  }

  /// Settles samples that start from their own winding numbers.
  static std::vector<float> settle(WindingDipolesStage& stage, const Mesh& mesh, const Grid& grid,
                                   const std::vector<float>& windings, const Start& start = {}) {
    const DeviceBuffer distance = upload(std::vector<float>(grid.sampleCount(), start.distance), "distance");
    const DeviceBuffer winding = upload(windings, "winding");
    const DeviceBuffer disagreeing = upload<uint32_t>({start.disagreeing}, "disagreeing");
    const DeviceBuffer change = upload<float>({start.change}, "change");
    withTree(stage, mesh, grid, [&](Commands& commands, const SurfaceTreeStage& tree) {
      stage.record(commands, tree,
                   {distance.address(), winding.address(), disagreeing.address(), change.address()},
                   start.looks, kThreshold);
    });
    return download<float>(winding);
  }

  static std::vector<float> numbersAt(WindingDipolesStage& stage, const Mesh& mesh, const Grid& grid,
                                      const std::vector<glm::vec3>& points) {
    const DeviceBuffer at = upload(points, "points");
    const DeviceBuffer numbers = upload(std::vector<float>(points.size()), "numbers");
    withTree(stage, mesh, grid, [&](Commands& commands, const SurfaceTreeStage& tree) {
      stage.recordNumbersAt(commands, tree, at.address(), static_cast<uint32_t>(points.size()),
                            numbers.address(), kThreshold);
    });
    return download<float>(numbers);
  }

  /// Runs what `record` records after the tree of the mesh.
  template <class Record>
  static void withTree(WindingDipolesStage& stage, const Mesh& mesh, const Grid& grid, Record&& record) {
    const CellMesh cells = cellMesh(mesh, grid);
    const DeviceBuffer vertices =
        upload(std::vector<glm::vec3>(cells.vertices.begin(), cells.vertices.end()), "vertices");
    const DeviceBuffer triangles =
        upload(std::vector<glm::uvec3>(cells.triangles.begin(), cells.triangles.end()), "triangles");
    const DeviceMesh onDevice{vertices.address(), triangles.address(),
                              static_cast<uint32_t>(cells.vertices.size()),
                              static_cast<uint32_t>(cells.triangles.size())};
    SurfaceTreeStage tree(device());
    tree.reserve(onDevice.triangleCount);
    stage.reserve(onDevice.triangleCount, grid.dims);
    run([&](Commands& commands) {
      tree.record(commands, onDevice, grid.dims);
      record(commands, tree);
    });
  }

  static Buffer<float> settleOnCpu(const Mesh& mesh, const Grid& grid, const Start& start) {
    Buffer<float> winding(grid.sampleCount());
    std::ranges::fill(winding, start.winding);
    std::vector<uint32_t> all(winding.size());
    std::iota(all.begin(), all.end(), 0u);
    cpu::SurfaceTree tree;
    tree.build(cellMesh(mesh, grid));
    Progress progress;
    cpu::WindingDipoles().settle(tree, grid.dims, all, kThreshold, {0, kLooks}, progress, winding);
    return winding;
  }

  /// Kept from one test to the next.
  static WindingDipolesStage& dipoles() {
    shared();  // The device is made before the stage, so it is destroyed after it.
    static WindingDipolesStage dipoles(device());
    return dipoles;
  }
};

Mesh openSphere(int subdivisions = 4) {
  Mesh mesh = shapes::sphere(1.0, subdivisions);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.4; });
  return mesh;
}

TEST_F(VulkanWindingDipoles, AreTheSumOfTheSolidAngles) {
  // One triangle, a leaf that is not full, one triangle more than a leaf holds, and thousands.
  for (const Mesh& mesh :
       {shapes::soup(1, 3), shapes::soup(5, 4), shapes::soup(9, 5), shapes::soup(1000, 6), openSphere()}) {
    SCOPED_TRACE(testing::Message() << mesh.triangles.size() << " triangles");
    const Grid grid = fitGrid(mesh, {.resolution = 16});
    const std::vector<float> winding = settle(mesh, grid, {});
    double sum = 0.0;
    for (size_t s = 0; s < winding.size(); ++s) {
      const double error = std::abs(winding[s] - reference::windingNumber(mesh, samplePosition(grid, s)));
      // Numbers near the threshold are computed more accurately.
      ASSERT_LT(error, std::abs(std::abs(winding[s]) - kThreshold) < 0.015 ? 0.005 : 0.05) << s;
      sum += error;
    }
    EXPECT_LT(sum / double(winding.size()), 0.008);
  }
}

TEST_F(VulkanWindingDipoles, MatchTheCpu) {
  for (const Mesh& mesh : {shapes::soup(9, 5), shapes::soup(1000, 6), openSphere()}) {
    SCOPED_TRACE(testing::Message() << mesh.triangles.size() << " triangles");
    const Grid grid = fitGrid(mesh, {.resolution = 20});
    const std::vector<float> ours = settle(mesh, grid, {});
    const Buffer<float> theirs = settleOnCpu(mesh, grid, {});
    size_t unlike = 0;
    double sum = 0.0;
    for (size_t s = 0; s < ours.size(); ++s) {
      unlike += (std::abs(ours[s]) > kThreshold) != (std::abs(theirs[s]) > kThreshold) ? 1 : 0;
      sum += std::abs(ours[s] - theirs[s]);
      ASSERT_NEAR(ours[s], theirs[s], 0.06f) << s;
    }
    EXPECT_LE(unlike, 1u) << "on different sides of the threshold";
    EXPECT_LT(sum / double(ours.size()), 0.004);
  }
}

TEST_F(VulkanWindingDipoles, GiveTheSameBitsEachTime) {
  const Mesh mesh = shapes::soup(1000, 6);
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  EXPECT_EQ(settle(mesh, grid, {}), settle(mesh, grid, {}));
}

/// Sizes of groups: one subgroup or several, on any device.
constexpr uint32_t kGroups[] = {8, 16, 64, 256};

TEST_F(VulkanWindingDipoles, AreTheSameForAnySizeOfGroups) {
  for (const Mesh& mesh : {shapes::soup(5, 4), shapes::soup(1000, 6), openSphere()}) {
    const Grid grid = fitGrid(mesh, {.resolution = 8});
    const std::vector<float> expected = settle(mesh, grid, {});
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
  const std::vector<float> all = settle(mesh, grid, {});
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
  for (const Start& start :
       {Start{.winding = 0.85f}, Start{.winding = -0.15f}, Start{.winding = 0.55f, .distance = 20.0f}})
    for (const float w : settle(mesh, grid, start)) ASSERT_EQ(w, start.winding);
}

TEST_F(VulkanWindingDipoles, DoubtMoreWhereTheFieldCannotFollowTheCrossings) {
  const Mesh mesh = openSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 12});
  // The doubt of 0.04 is 1.5 and 0.9 times as large.
  for (const float w : settle(mesh, grid, {.winding = 0.55f, .distance = 20.0f, .change = 0.5f}))
    ASSERT_NE(w, 0.55f);
  for (const float w : settle(mesh, grid, {.winding = 0.545f, .distance = 20.0f, .change = 0.3f}))
    ASSERT_EQ(w, 0.545f);
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
  for (const float w : settle(mesh, fitGrid(mesh, {.resolution = 16}), {})) ASSERT_TRUE(std::abs(w) < 1.1f);
}

}  // namespace
}  // namespace raymap::vulkan
