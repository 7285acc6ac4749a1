#include "vulkan/primitives/dispatch_arguments.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "shaders/count_runs.h"
#include "shaders/count_runs_spv.h"
#include "shaders/dispatch_arguments_spv.h"
#include "shaders/number_invocations.h"
#include "shaders/number_invocations_spv.h"
#include "vulkan/device/dispatch_limits.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

using NumberKernel = Kernel<NumberInvocationsPush>;

class VulkanDispatch : public VulkanTest {
 protected:
  /// Expects the number of its group plus 1 for each invocation that ran, and 0 for the others.
  static void expectGroups(const DeviceBuffer& numbers, uint32_t groupSize, uint64_t invocations) {
    const std::vector<uint32_t> found = download<uint32_t>(numbers);
    for (uint32_t i = 0; i < found.size(); ++i)
      ASSERT_EQ(found[i], i < invocations ? 1 + i / groupSize : 0u) << i << " of " << invocations;
  }
};

TEST_F(VulkanDispatch, DispatchesWhatTheDeviceCounted) {
  const uint32_t groupSize = 32;
  NumberKernel kernel(device(), shaders::kNumberInvocations, groupSize, {7});
  DispatchArguments arguments(device(), "arguments");
  arguments.reserve({.most = 3000000, .itemsPerGroup = groupSize, .mostGroups = UINT32_MAX});
  for (const uint32_t count : {0U, 1U, kMaxGroups * groupSize + 1}) {
    DeviceBuffer buffer(device(), "groups");
    buffer.resize<uint32_t>(3000000);
    const DeviceBuffer counted = upload(std::vector<uint32_t>{count}, "count");
    run([&](Commands& commands) {
      commands.fill(buffer, 0);
      arguments.record(commands, counted.address());
      arguments.dispatch(commands, kernel,
                         {.groups = buffer.address(), .count = 3000000, .groupSize = groupSize});
    });
    const std::vector<uint32_t> groups = download<uint32_t>(buffer);
    const uint32_t all = (count + groupSize - 1) / groupSize;
    EXPECT_EQ(all == 0 ? 6 : groups[all * groupSize - 1], 7 + all - 1);
    // Dispatches over two dimensions may have more groups than needed.
    EXPECT_EQ(groups[(all + 1) * groupSize], 0u);
  }
}

TEST_F(VulkanDispatch, SplitsWhatTheDeviceCounted) {
  constexpr uint32_t kSize = 16, kMost = 5, kCapacity = 30 * kSize;
  NumberKernel kernel(device(), shaders::kNumberInvocations, kSize, {1});
  DispatchArguments arguments(device(), "arguments");
  arguments.reserve({.most = 20 * kSize, .itemsPerGroup = kSize, .mostGroups = kMost});
  for (const uint32_t groups : {0u, 1u, 4u, 5u, 6u, 15u, 19u, 20u, 21u}) {
    DeviceBuffer numbers(device(), "groups");
    numbers.resize<uint32_t>(kCapacity);
    const DeviceBuffer counted = upload(std::vector<uint32_t>{groups * kSize}, "count");
    run([&](Commands& commands) {
      commands.fill(numbers, 0);
      arguments.record(commands, counted.address());
      arguments.dispatch(commands, kernel,
                         {.groups = numbers.address(), .count = kCapacity, .groupSize = kSize});
    });
    expectGroups(numbers, kSize, uint64_t{std::min(groups, 20u)} * kSize);
  }
}

TEST_F(VulkanDispatch, SplitsWhatAGateLetsThrough) {
  constexpr uint32_t kSize = 16, kMost = 5, kCapacity = 30 * kSize;
  NumberKernel kernel(device(), shaders::kNumberInvocations, kSize, {1});
  DispatchArguments gate(device(), "gate");
  const std::vector<uint64_t> groups{0, 1, 5, 6, 20, 23};
  gate.plan(groups, kMost);
  for (const uint32_t word : {0u, 9u}) {
    const DeviceBuffer opening = upload(std::vector<uint32_t>{word}, "word");
    for (uint32_t d = 0; d < groups.size(); ++d) {
      DeviceBuffer numbers(device(), "groups");
      numbers.resize<uint32_t>(kCapacity);
      run([&](Commands& commands) {
        commands.fill(numbers, 0);
        gate.record(commands, opening.address());
        gate.dispatch(commands, kernel, {.groups = numbers.address(), .count = kCapacity, .groupSize = kSize},
                      d);
      });
      expectGroups(numbers, kSize, word == 0 ? 0 : groups[d] * kSize);
    }
  }
  gate.plan(std::array{uint64_t{kMaxGroups} + 1});  // Over two dimensions.
  DeviceBuffer numbers(device(), "groups");
  numbers.resize<uint32_t>(uint64_t{kMaxGroups + 1} * kSize);
  const DeviceBuffer open = upload(std::vector<uint32_t>{1}, "word");
  run([&](Commands& commands) {
    gate.record(commands, open.address());
    gate.dispatch(commands, kernel,
                  {.groups = numbers.address(), .count = (kMaxGroups + 1) * kSize, .groupSize = kSize}, 0);
  });
  expectGroups(numbers, kSize, uint64_t{kMaxGroups + 1} * kSize);
}

TEST_F(VulkanDispatch, RunsEveryGroupOfLargePartsOnce) {
  constexpr uint32_t kSize = 8, kParts = 3;
  Kernel<CountRunsPush> kernel(device(), shaders::kCountRuns, kSize);
  for (const uint32_t most : {kMostGroups, kMaxGroups}) {
    const uint32_t groups = (kParts - 1) * most + 3, listed = groups + kParts;
    const DeviceBuffer counted = upload(std::vector<uint32_t>{groups}, "count");
    DispatchArguments arguments(device(), "arguments");
    const uint32_t surplus = most == kMaxGroups ? 7 : 0;  // Rounded off, as they would run twice.
    arguments.reserve({.most = groups, .mostGroups = most + surplus});
    DispatchArguments gate(device(), "gate");
    gate.plan(std::array{uint64_t{groups}}, most + surplus);
    const DeviceBuffer bySize = upload(std::vector<uint32_t>(listed)),
                       byGate = upload(std::vector<uint32_t>(listed));
    run([&](Commands& commands) {
      arguments.record(commands, counted.address());
      arguments.dispatch(commands, kernel, {bySize.address(), listed, 0});
      gate.record(commands, counted.address());
      gate.dispatch(commands, kernel, {byGate.address(), listed, 0}, 0);
    });
    std::vector<uint32_t> once(listed, kSize);
    std::fill(once.begin() + groups, once.end(), 0);
    EXPECT_EQ(download<uint32_t>(bySize), once) << most;
    EXPECT_EQ(download<uint32_t>(byGate), once) << most;
  }
}

TEST_F(VulkanDispatch, RefusesPartsOfAKernelThatDoesNotNumberItsGroups) {
  DispatchArguments arguments(device(), "arguments");
  arguments.reserve({.most = kMostGroups + 1});
  Kernel<DispatchArgumentsPush> kernel(device(), shaders::kDispatchArguments, 32);
  CommandBuffer buffer(device());
  Commands commands = buffer.begin();
  EXPECT_THROW(arguments.dispatch(commands, kernel, {}), std::logic_error);
}

}  // namespace
}  // namespace raymap::vulkan
