#include "vulkan/stages/distance_transform.h"

#include "cells.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanDistanceTransform : public VulkanTest {
 protected:
  static std::vector<uint32_t> nearestCells(DistanceTransformStage& transform, glm::ivec3 dims,
                                            const std::vector<float>& squared) {
    const DeviceBuffer values = upload(squared, "squared");
    transform.reserve(dims);
    run([&](Commands& commands) { transform.record(commands, values.address()); });
    EXPECT_EQ(download<float>(values), squared);
    return download<uint32_t>(transform.nearestCells());
  }

  /// Expects the CPU's cells, and the values of the formula in vulkan/stages/distance_transform.h.
  static void expectAsOnTheCpu(DistanceTransformStage& transform, glm::ivec3 dims, const Buffer<float>& f) {
    Progress progress;
    Buffer<float> squared = f.clone();
    Buffer<uint32_t> nearest;
    transformDistance(dims, progress, squared, nearest);
    const std::vector<uint32_t> ours = nearestCells(transform, dims, {f.begin(), f.end()});
    ASSERT_TRUE(std::ranges::equal(ours, nearest));
    const CellLattice cells{dims};
    for (size_t p = 0; p < ours.size(); ++p) {
      if (ours[p] == kNoCell) continue;
      const glm::vec3 d(cells.cell(p) - cells.cell(ours[p]));
      ASSERT_EQ(squared[p], d.z * d.z + (d.y * d.y + (d.x * d.x + f[ours[p]]))) << p;
    }
    ASSERT_EQ(ours, nearestCells(transform, dims, {f.begin(), f.end()})) << "the second time";
  }
};

TEST_F(VulkanDistanceTransform, FindsTheCellsThatTheCpuFinds) {
  DistanceTransformStage transform(device());
  unsigned seed = 0;
  for (const glm::ivec3 dims :
       {glm::ivec3(14, 9, 11), glm::ivec3(48, 40, 33), glm::ivec3(1, 33, 20), glm::ivec3(70, 1, 13),
        glm::ivec3(37, 21, 1), glm::ivec3(1, 1, 300), glm::ivec3(1, 700, 1), glm::ivec3(1, 1, 1)})
    for (const double share : {0.0, 0.004, 0.1, 1.0})
      for (const bool isWhole : {false, true}) {
        SCOPED_TRACE(::testing::Message() << dims.x << " x " << dims.y << " x " << dims.z << ", " << share);
        expectAsOnTheCpu(transform, dims, randomCells(dims, share, ++seed, isWhole));
      }
}

TEST_F(VulkanDistanceTransform, FindsTheCellsThatTheCpuFindsOnLongLines) {
  DistanceTransformStage transform(device());
  for (const glm::ivec3 dims : {glm::ivec3(2048, 3, 2), glm::ivec3(3, 2048, 2), glm::ivec3(3, 2, 2048)})
    for (const double share : {0.0005, 0.002, 0.5}) {
      SCOPED_TRACE(::testing::Message() << dims.x << " x " << dims.y << " x " << dims.z << ", " << share);
      expectAsOnTheCpu(transform, dims, randomCells(dims, share, 7));
      expectAsOnTheCpu(transform, dims, randomCells(dims, share, 8, true));
    }
}

TEST_F(VulkanDistanceTransform, TakesTheLowerOfAlmostEqualValues) {
  // Values so small that they vanish when added to a squared distance.
  DistanceTransformStage transform(device());
  const glm::ivec3 dims(40, 6, 50);
  Buffer<float> f = randomCells(dims, 0.01, 3, true);
  std::mt19937 random(4);
  for (float& value : f)
    if (value == 0.0f) value = 1e-14f * static_cast<float>(random() % 1000);
  expectAsOnTheCpu(transform, dims, f);
}

TEST_F(VulkanDistanceTransform, RefusesLinesThatDoNotFit) {
  DistanceTransformStage transform(device());
  EXPECT_THROW(transform.reserve({100000, 1, 1}), Error);
}

}  // namespace
}  // namespace raymap::vulkan
