#include "vulkan/device/commands.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "shaders/number_invocations.h"
#include "shaders/number_invocations_spv.h"
#include "shaders/subgroup_sizes.h"
#include "shaders/subgroup_sizes_spv.h"
#include "vulkan/device/dispatch_limits.h"
#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

using NumberKernel = Kernel<NumberInvocationsPush>;

class VulkanCommands : public VulkanTest {};

TEST_F(VulkanCommands, ComparesPushConstants) {
  EXPECT_THROW(Kernel<DispatchArgumentsPush>(device(), shaders::kNumberInvocations, 64), std::logic_error);
}

TEST_F(VulkanCommands, HasSubgroupsOfTheReportedSize) {
  // Mesa's cache may hold a kernel of the same group size for another LP_NATIVE_VECTOR_WIDTH.
  const uint32_t size = std::max(128u, device().limits().maxSubgroupSize);
  Kernel<SubgroupSizesPush> kernel(device(), shaders::kSubgroupSizes, size);
  const DeviceBuffer sizes = upload(std::vector<uint32_t>(size), "sizes");
  run([&](Commands& commands) { commands.dispatch(kernel, SubgroupSizesPush{sizes.address()}, size); });
  for (const uint32_t found : download<uint32_t>(sizes)) {
    EXPECT_GE(found, device().limits().minSubgroupSize);
    EXPECT_LE(found, device().limits().maxSubgroupSize);
  }
}

TEST_F(VulkanCommands, NumbersInvocationsBeyondOneDimension) {
  const uint32_t groupSize = 32;
  for (const uint32_t count : {1U, 33U, kMaxGroups * groupSize, kMaxGroups * groupSize + 1, 5000001U}) {
    DeviceBuffer buffer(device(), "groups");
    buffer.resize<uint32_t>(count);
    NumberKernel kernel(device(), shaders::kNumberInvocations, groupSize, {7});
    run([&](Commands& commands) {
      commands.fill(buffer, 0);
      commands.dispatch(kernel, {.groups = buffer.address(), .count = count, .groupSize = groupSize}, count);
    });
    const std::vector<uint32_t> groups = download<uint32_t>(buffer);
    size_t wrong = 0;
    for (size_t i = 0; i < count; ++i) wrong += groups[i] != 7 + i / groupSize ? 1 : 0;
    EXPECT_EQ(wrong, 0u) << count;
  }
}

TEST_F(VulkanCommands, NumbersInvocationsAcrossDispatches) {
  for (const uint32_t groupSize : {64u, 128u})
    for (const uint64_t count : {uint64_t{kMostInvocations}, uint64_t{kMostInvocations} + 1,
                                 3 * uint64_t{kMostInvocations} + 1000}) {
      const DeviceBuffer numbers = upload(std::vector<uint32_t>(count, UINT32_MAX));
      NumberKernel kernel(device(), shaders::kNumberInvocations, groupSize);
      const NumberInvocationsPush push{
          .groups = numbers.address(), .count = uint32_t(count), .groupSize = groupSize};
      for (const uint64_t weight : {1, 7, 64}) {
        run([&](Commands& commands) {
          commands.fill(numbers, UINT32_MAX);
          commands.dispatch(kernel, push, count, weight);
        });
        const std::vector<uint32_t> found = download<uint32_t>(numbers);
        for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(found[i], i / groupSize) << count << ", " << weight;
      }
    }
}

/// Continues in new command buffers, as often as it is called.
class Restarts final : public RecordingListener {
 public:
  explicit Restarts(CommandBuffer& buffer) : buffer_(buffer), commands_(begin()) {}
  Commands& commands() { return commands_; }
  void onMuchWork() override {
    ++count;
    buffer_.submitAndWait();
    commands_ = begin();
  }
  void onProgress(double done) override { progress.push_back(done); }

  int count = 0;
  std::vector<double> progress;

 private:
  Commands begin() {
    Commands commands = buffer_.begin();
    commands.listen(this);
    return commands;
  }
  CommandBuffer& buffer_;
  Commands commands_;
};

TEST_F(VulkanCommands, PausesWhenMuchWorkIsRecorded) {
  constexpr uint64_t kMostSubmitted = uint64_t{1} << 27, kCount = uint64_t{1} << 24;
  DeviceBuffer numbers(device(), "numbers");
  numbers.resize<uint32_t>(kCount);
  NumberKernel kernel(device(), shaders::kNumberInvocations, 128);
  const NumberInvocationsPush push{.groups = numbers.address(), .count = kCount, .groupSize = 128};
  const auto pausesAfter = [&](uint64_t dispatches, uint64_t weight = 1) {
    CommandBuffer buffer(device());
    Restarts restarts(buffer);
    for (uint64_t d = 0; d < dispatches; ++d) restarts.commands().dispatch(kernel, push, kCount, weight);
    restarts.commands().report(0.25);
    buffer.submitAndWait();
    EXPECT_EQ(restarts.progress, std::vector<double>{0.25});
    return restarts.count;
  };
  EXPECT_EQ(pausesAfter(kMostSubmitted / kCount), 0);
  EXPECT_EQ(pausesAfter(kMostSubmitted / kCount + 1), 1);
  EXPECT_EQ(pausesAfter(1, 8), 0);
  EXPECT_EQ(pausesAfter(2, 8), 1);
  // A pause may fall between the dispatches of one kernel.
  NumberKernel other(device(), shaders::kNumberInvocations, 128, {7});
  CommandBuffer buffer(device());
  Restarts restarts(buffer);
  restarts.commands().fill(numbers, 0);
  for (uint64_t done = kMostInvocations; done < kMostSubmitted; done += kMostInvocations)
    restarts.commands().dispatch(kernel, push, kMostInvocations);
  restarts.commands().dispatch(other, push, kCount);
  buffer.submitAndWait();
  EXPECT_EQ(restarts.count, 1);
  const std::vector<uint32_t> found = download<uint32_t>(numbers);
  for (uint32_t i = 0; i < kCount; ++i) ASSERT_EQ(found[i], 7 + i / 128) << i;
}

TEST_F(VulkanCommands, SubmitsMorePartsThanItHasBuffers) {
  constexpr uint32_t kParts = 11;
  DeviceBuffer value(device(), "value"), seen(device(), "seen", MemoryUse::ReadBack);
  value.resize<uint32_t>(1);
  seen.resize<uint32_t>(kParts);
  CommandBuffer buffer(device());
  for (const uint32_t first : {1U, 100U}) {  // Parts are numbered from 0 again.
    Commands commands = buffer.begin();
    for (uint32_t part = 0; part < kParts; ++part) {
      commands.fill(value, first + part);
      commands.copy(value, seen.handle(), seen.offset() + part * sizeof(uint32_t), sizeof(uint32_t));
      EXPECT_EQ(buffer.submitPart(commands), part);
      if (first == 1 && part % 3 == 0) {
        buffer.waitForPart(part);
        EXPECT_EQ(seen.mapped<uint32_t>()[part], first + part);
      }
    }
    buffer.waitForPart(0);
    buffer.submitAndWait();
    for (uint32_t part = 0; part < kParts; ++part) EXPECT_EQ(seen.mapped<uint32_t>()[part], first + part);
  }
}

}  // namespace
}  // namespace raymap::vulkan
