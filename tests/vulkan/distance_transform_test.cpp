#include "vulkan/stages/distance_transform.h"

#include "cells.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanDistanceTransform : public VulkanTest {};

void expectAsOnTheCpu(const glm::ivec3& dims, const Buffer<float>& squared) {
  compareTransform(VulkanTest::kept<CellProbe>(), dims, squared);
}

TEST_F(VulkanDistanceTransform, FindsTheCellsThatTheCpuFinds) {
  unsigned seed = 0;
  for (const glm::ivec3 dims :
       {glm::ivec3(14, 9, 11), glm::ivec3(48, 40, 33), glm::ivec3(1, 33, 20), glm::ivec3(70, 1, 13),
        glm::ivec3(37, 21, 1), glm::ivec3(1, 1, 300), glm::ivec3(1, 700, 1), glm::ivec3(1, 1, 1)})
    for (const double share : {0.0, 0.004, 0.1, 1.0})
      for (const bool isWhole : {false, true})
        expectAsOnTheCpu(dims, randomCells(dims, share, ++seed, isWhole));
}

TEST_F(VulkanDistanceTransform, FindsTheCellsThatTheCpuFindsOnLongLines) {
  for (const glm::ivec3 dims : {glm::ivec3(2048, 3, 2), glm::ivec3(3, 2048, 2), glm::ivec3(3, 2, 2048)})
    for (const double share : {0.0005, 0.002, 0.5}) {
      expectAsOnTheCpu(dims, randomCells(dims, share, 7));
      expectAsOnTheCpu(dims, randomCells(dims, share, 8, true));
    }
  for (const TwoCells& two : closeCells()) expectAsOnTheCpu({2001, 1, 1}, two.squared());
}

TEST_F(VulkanDistanceTransform, TakesTheLowerOfAlmostEqualValues) {
  // Values so small that they vanish when added to a squared distance.
  const glm::ivec3 dims(40, 6, 50);
  Buffer<float> f = randomCells(dims, 0.01, 3, true);
  std::mt19937 random(4);
  for (float& value : f)
    if (value == 0.0f) value = 1e-14f * static_cast<float>(random() % 1000);
  expectAsOnTheCpu(dims, f);
}

TEST_F(VulkanDistanceTransform, RefusesLinesThatDoNotFit) {
  DistanceTransformStage transform(device());
  EXPECT_THROW(transform.reserve({100000, 1, 1}), Error);
}

}  // namespace
}  // namespace raymap::vulkan
