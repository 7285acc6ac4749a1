#include "vulkan/stages/distance_transform.h"

#include "cells.h"
#include "told_limits.h"
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

TEST_F(VulkanDistanceTransform, FindsCellsAtTheEndsOfLines) {
  for (const int length : {2, 15, 16, 17, 32, 33, 65, 150, 513})
    for (const glm::vec2 ends : {glm::vec2(0.0f), glm::vec2(1.0f), glm::vec2(0.0f, 1.0f), glm::vec2(0.5f)}) {
      const CellLattice cells{{5, length, length > 99 ? 2 : length}};
      Buffer<float> f = randomCells(cells.dims, 0.0, 1);
      for (const float end : {ends.x, ends.y})
        f[cells.index({3, end * float(length - 1), end * float(cells.dims.z - 1)})] = 0.25f;
      expectAsOnTheCpu(cells.dims, f);
    }
}

TEST_F(VulkanDistanceTransform, FitsIntoLittleSharedMemory) {
  Device little = deviceTelling(
      [](VkPhysicalDeviceProperties2& told) { told.properties.limits.maxComputeSharedMemorySize = 24576; });
  CellProbe probe(little);
  unsigned seed = 0;
  for (const glm::ivec3 dims : {glm::ivec3(3, 2944, 1), glm::ivec3(2, 1, 2944), glm::ivec3(40, 130, 17)})
    for (const double share : {0.001, 0.3}) compareTransform(probe, dims, randomCells(dims, share, ++seed));
  EXPECT_THROW(DistanceTransformStage(little).reserve({1, 2945, 1}), Error);
}

TEST_F(VulkanDistanceTransform, RefusesLinesThatDoNotFit) {
  DistanceTransformStage transform(device());
  EXPECT_THROW(transform.reserve({100000, 1, 1}), Error);
}

}  // namespace
}  // namespace raymap::vulkan
