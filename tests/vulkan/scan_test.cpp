#include "vulkan/primitives/scan.h"

#include <numeric>
#include <random>

#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

std::vector<uint32_t> randomValues(size_t count) {
  std::mt19937 random(static_cast<uint32_t>(count));
  std::vector<uint32_t> values(count);
  for (uint32_t& value : values) value = random() >> 8;
  return values;
}

/// Returns the prefix sums, with the total at the end.
std::vector<uint32_t> expectedSums(std::vector<uint32_t> values) {
  values.push_back(0);
  std::exclusive_scan(values.begin(), values.end(), values.begin(), 0U);
  return values;
}

class VulkanScan : public VulkanTest, public ::testing::WithParamInterface<uint32_t> {
 protected:
  /// Uploads values with space for the total, so that the sums can replace them.
  static DeviceBuffer uploadValues(std::vector<uint32_t> values) {
    values.push_back(0xDEADBEEF);
    return upload(values, "values");
  }
};

TEST_P(VulkanScan, IsTheExclusivePrefixSum) {
  const std::vector<uint32_t> values = randomValues(GetParam());
  const DeviceBuffer in = uploadValues(values);
  DeviceBuffer out(device(), "sums");
  out.resize<uint32_t>(values.size() + 1);
  Scan scan(device());
  scan.reserve(GetParam());
  const auto record = [&](Commands& commands) {
    scan.record(commands, in.address(), out.address(), {.most = GetParam()});
  };
  run(record);
  EXPECT_EQ(download<uint32_t>(out), expectedSums(values));
  run(record);
  EXPECT_EQ(download<uint32_t>(out), expectedSums(values)) << "the second time";
}

TEST_P(VulkanScan, SumsInPlace) {
  const std::vector<uint32_t> values = randomValues(GetParam());
  const DeviceBuffer buffer = uploadValues(values);
  Scan scan(device());
  scan.reserve(GetParam());
  run([&](Commands& commands) {
    scan.record(commands, buffer.address(), buffer.address(), {.most = GetParam()});
  });
  EXPECT_EQ(download<uint32_t>(buffer), expectedSums(values));
}

TEST_P(VulkanScan, SumsAsManyAsTheDeviceCounted) {
  std::vector<uint32_t> values = randomValues(GetParam());
  const DeviceBuffer in = uploadValues(values);
  DeviceBuffer out(device(), "sums");
  out.resize<uint32_t>(values.size() + 1);
  Scan scan(device());
  const uint32_t most = GetParam() + 100000;  // For some sizes more levels than needed.
  scan.reserve(most);
  const DeviceBuffer count = upload<uint32_t>({GetParam()}, "count");
  run([&](Commands& commands) {
    scan.record(commands, in.address(), out.address(), {.most = most, .address = count.address()});
  });
  EXPECT_EQ(download<uint32_t>(out), expectedSums(values));
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
    scan.record(commands, buffer.address(), buffer.address(), {.most = size});
  });
  const std::vector<uint32_t> sums = download<uint32_t>(buffer);
  size_t wrong = 0;
  for (size_t i = 0; i < sums.size(); ++i) wrong += sums[i] != i ? 1 : 0;
  EXPECT_EQ(wrong, 0u);
}

TEST_F(VulkanScanLimits, HoldForCountsOfTheDevice) {
  const std::vector<uint32_t> values(5001, 1);
  const DeviceBuffer buffer = upload(values);
  const DeviceBuffer count = upload<uint32_t>({1000000}, "count");
  Scan scan(device());
  scan.reserve(5000);
  run([&](Commands& commands) {
    scan.record(commands, buffer.address(), buffer.address(), {.most = 5000, .address = count.address()});
  });
  EXPECT_EQ(download<uint32_t>(buffer).back(), 5000u);
}

TEST_F(VulkanScanLimits, RefuseMoreValuesThanReservedAndUnalignedOnes) {
  const DeviceBuffer buffer = upload(std::vector<uint32_t>(100));
  Scan scan(device());
  scan.reserve(10);
  CommandBuffer own(device());
  Commands commands = own.begin();
  EXPECT_THROW(scan.record(commands, buffer.address(), buffer.address(), {.most = 11}), std::logic_error);
  EXPECT_THROW(scan.record(commands, buffer.address() + 4, buffer.address(), {.most = 5}), std::logic_error);
  EXPECT_THROW(scan.reserve(0x80000001U), std::logic_error);
}

}  // namespace
}  // namespace raymap::vulkan
