#include "vulkan/primitives/scan.h"

#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanScan : public VulkanTest, public ::testing::WithParamInterface<uint32_t> {};

TEST_P(VulkanScan, IsTheExclusivePrefixSum) {
  compareScan(Probe(device()), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Sizes, VulkanScan,
                         ::testing::Values(0, 1, 7, 255, 256, 257, 4095, 4096, 4097, 65535, 65536, 65537,
                                           196607, 196609, 3000000),
                         ::testing::PrintToStringParamName());

class VulkanScanLimits : public VulkanTest {};

TEST_F(VulkanScanLimits, AllowThreeLevels) {
  const uint32_t size = (1U << 24) + 5000;
  DeviceBuffer buffer(device(), "ones");
  buffer.resize<uint32_t>(size + 1);
  Scan scan(device());
  scan.reserve(size);
  run([&](Commands& commands) {
    commands.fill(buffer, 1);
    scan.record(commands, buffer.address(), buffer.address(), size);
  });
  const std::vector<uint32_t> sums = download<uint32_t>(buffer);
  size_t wrong = 0;
  for (size_t i = 0; i < sums.size(); ++i) wrong += sums[i] != i ? 1 : 0;
  EXPECT_EQ(wrong, 0u);
}

TEST_F(VulkanScanLimits, RefuseMoreValuesThanReservedAndUnalignedOnes) {
  const DeviceBuffer buffer = upload(std::vector<uint32_t>(100));
  Scan scan(device());
  scan.reserve(10);
  CommandBuffer own(device());
  Commands commands = own.begin();
  EXPECT_THROW(scan.record(commands, buffer.address(), buffer.address(), 11), std::logic_error);
  EXPECT_THROW(scan.record(commands, buffer.address() + 4, buffer.address(), 5), std::logic_error);
  EXPECT_THROW(scan.reserve(0x80000001U), std::logic_error);
}

}  // namespace
}  // namespace raymap::vulkan
