#include "vulkan/primitives/radix_sort.h"

#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanRadixSort : public VulkanTest, public ::testing::WithParamInterface<uint32_t> {};

TEST_P(VulkanRadixSort, SortsLikeTheStandardLibrary) {
  const Probe probe(device());
  compareRadixSort(probe, GetParam(), 32);
  const uint32_t count = std::min(GetParam(), 200000U);
  for (const uint32_t bits : {3U, 11U, 17U}) compareRadixSort(probe, count, bits);
}

INSTANTIATE_TEST_SUITE_P(Sizes, VulkanRadixSort,
                         ::testing::Values(0, 1, 7, 255, 256, 257, 2047, 2048, 2049, 65535, 65536, 65537,
                                           196607, 196609, 3000000),
                         ::testing::PrintToStringParamName());

class VulkanRadixSortLimits : public VulkanTest {};

TEST_F(VulkanRadixSortLimits, RefuseMoreKeysOrBitsThanReserved) {
  RadixSort sort(device());
  sort.reserve(10);
  CommandBuffer own(device());
  Commands commands = own.begin();
  EXPECT_THROW(sort.record(commands, {}, {}, 11, 32), std::logic_error);
  EXPECT_THROW(sort.record(commands, {}, {}, 10, 33), std::logic_error);
  EXPECT_THROW(sort.reserve(0x40000001U), std::logic_error);
}

}  // namespace
}  // namespace raymap::vulkan
