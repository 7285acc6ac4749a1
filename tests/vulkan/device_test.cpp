#include "vulkan_device.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "environment.h"
#include "files.h"
#include "shaders/count_runs.h"
#include "shaders/count_runs_spv.h"
#include "shaders/number_invocations.h"
#include "shaders/number_invocations_spv.h"
#include "shaders/subgroup_sizes.h"
#include "shaders/subgroup_sizes_spv.h"
#include "testing/kernels/vulkan_entry.h"
#include "vulkan/device/dispatch_limits.h"
#include "vulkan/device/features.h"
#include "vulkan/device/scratch_memory.h"
#include "vulkan/device/spirv.h"
#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan/primitives/gate.h"

namespace raymap::vulkan {
namespace {

using NumberKernel = Kernel<NumberInvocationsPush>;

constexpr const char* kNoLayer = "needs the validation layer, but RAYMAP_VULKAN_VALIDATION is off";

ErrorCode codeOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.code();
  }
  return {};
}

TEST(VulkanErrors, KeepTheirCodes) {
  EXPECT_EQ(codeOf([] { check(VK_ERROR_DEVICE_LOST, "waiting"); }), ErrorCode::DeviceLost);
  EXPECT_EQ(codeOf([] { check(VK_ERROR_OUT_OF_DEVICE_MEMORY, "allocating"); }), ErrorCode::Memory);
  EXPECT_EQ(codeOf([] { check(VK_ERROR_OUT_OF_HOST_MEMORY, "allocating"); }), ErrorCode::Memory);
  EXPECT_EQ(codeOf([] { check(VK_ERROR_FEATURE_NOT_PRESENT, "starting"); }), ErrorCode::Unsupported);
}

TEST(VulkanDevices, PreferHardwareOverSoftware) {
  using enum DeviceType;
  const auto best = [](const std::vector<DeviceType>& types, size_t broken = SIZE_MAX) {
    std::vector<DeviceInfo> devices;
    for (const DeviceType type : types) devices.push_back({.type = type});
    if (broken < devices.size()) devices[broken].problem = "broken";
    return bestDevice(devices);
  };
  EXPECT_EQ(best({Software, Integrated, Discrete, Discrete}), 2u);
  EXPECT_EQ(best({Software, Integrated, Discrete}, 2), 1u);
  EXPECT_EQ(best({Software}), 0u);
  EXPECT_EQ(best({Software}, 0), std::nullopt);
  EXPECT_EQ(best({}), std::nullopt);
}

TEST(VulkanSpirv, ReportsTheSizeOfPushConstants) {
  EXPECT_EQ(pushConstantBytes(shaders::kNumberInvocations.code), sizeof(NumberInvocationsPush));
  EXPECT_EQ(pushConstantBytes(shaders::kNumberInvocations.code.first(5)), 0u);
}

TEST(VulkanSpirv, VisitsEveryInstructionOnce) {
  const std::span<const uint32_t> code = shaders::kNumberInvocations.code;
  constexpr uint32_t kCapability = 17, kFunctionEnd = 56;
  std::vector<uint32_t> words, opcodes;
  forEachInstruction(code, [&](std::span<const uint32_t> instruction) {
    words.insert(words.end(), instruction.begin(), instruction.end());
    opcodes.push_back(opOf(instruction));
  });
  EXPECT_TRUE(std::ranges::equal(words, code.subspan(kSpirvHeaderWords)));
  EXPECT_EQ(opcodes.front(), kCapability);
  EXPECT_EQ(opcodes.back(), kFunctionEnd);
  forEachInstruction(code.first(kSpirvHeaderWords), [](std::span<const uint32_t>) { FAIL(); });
}

class VulkanDevice : public VulkanTest {
 protected:
  /// Expects the number of its group plus 1 for each invocation that ran, and 0 for the others.
  static void expectGroups(const DeviceBuffer& numbers, uint32_t groupSize, uint64_t invocations) {
    const std::vector<uint32_t> found = download<uint32_t>(numbers);
    for (uint32_t i = 0; i < found.size(); ++i)
      ASSERT_EQ(found[i], i < invocations ? 1 + i / groupSize : 0u) << i << " of " << invocations;
  }

  /// Returns the messages of the validation layer since the test began, which then do not fail it.
  static std::string takeMessages() {
    const std::lock_guard lock(shared().mutex);
    std::string all;
    for (const std::string& message : shared().messages) all += message + "\n";
    shared().messages.clear();
    return all;
  }
};

TEST_F(VulkanDevice, DescribesItself) {
  EXPECT_FALSE(device().info().name.empty());
  EXPECT_EQ(device().info().problem, "");
  EXPECT_GE(device().limits().sharedMemory, 16384u);
  EXPECT_GE(device().limits().groupSize, 128u);
  EXPECT_GT(device().limits().bufferSize, 1u << 30);
  EXPECT_GE(device().limits().maxSubgroupSize, device().limits().minSubgroupSize);
  const std::vector<DeviceInfo> all = listDevices();
  EXPECT_TRUE(std::any_of(all.begin(), all.end(),
                          [](const DeviceInfo& info) { return info.name == device().info().name; }));
}

TEST_F(VulkanDevice, RefusesAnUnknownNumber) {
  EXPECT_EQ(codeOf([] { const Device none({.index = 1000}); }), ErrorCode::Unsupported);
}

TEST_F(VulkanDevice, ReportsMessagesOfTheValidationLayer) {
  if (!isValidated()) GTEST_SKIP() << kNoLayer;
  const VkBufferCreateInfo empty{
      .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 0, .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
  BufferHandle buffer;
  try {
    create(buffer, device().handle(), vkCreateBuffer, empty, "making an empty buffer");
  } catch (const Error&) {  // The driver may fail or not.
  }
  EXPECT_NE(takeMessages().find("VUID-VkBufferCreateInfo-size"), std::string::npos);
}

TEST_F(VulkanDevice, ReportsHazards) {
  if (!isValidated()) GTEST_SKIP() << kNoLayer;
  if (validationFromEnvironment() != Validation::Off && validationFromEnvironment() != Validation::Sync)
    GTEST_SKIP() << "looks for other mistakes";
  const DeviceBuffer buffer = upload(std::vector<uint32_t>(1000));
  run([&](Commands& commands) {
    commands.fill(buffer, 1);
    commands.fill(buffer, 2);
  });
  EXPECT_EQ(takeMessages(), "");
  run([&](Commands& commands) {
    commands.concurrent([&] {
      commands.fill(buffer, 1);
      commands.fill(buffer, 2);
    });
  });
  EXPECT_NE(takeMessages().find("SYNC-HAZARD-WRITE-AFTER-WRITE"), std::string::npos);
}

TEST_F(VulkanDevice, FindsStrayWrites) {
  DeviceBuffer buffer = upload(std::vector<uint32_t>(1000), "watched");
  buffer.resize<uint32_t>(990);
  EXPECT_EQ(device().guards()->damaged(), "");
  NumberKernel kernel(device(), shaders::kNumberInvocations, 64);
  const auto writeAt = [&](VkDeviceAddress address) {
    CommandBuffer own(device());
    Commands commands = own.begin();
    commands.dispatch(kernel, {.groups = address, .count = 1, .groupSize = 64}, 1);
    own.submitAndWait();
    const std::string damaged = device().guards()->damaged();
    buffer.resize<uint32_t>(990);  // Repairs the guards.
    return damaged;
  };
  EXPECT_EQ(writeAt(buffer.address() + 989 * 4), "");
  EXPECT_NE(writeAt(buffer.address() - 8).find("watched: written 8 bytes before"), std::string::npos);
  EXPECT_NE(writeAt(buffer.address() + 992 * 4).find("watched: written 8 bytes beyond"), std::string::npos);
}

TEST_F(VulkanDevice, KeepsABuffersMemory) {
  const uint64_t before = device().heldMemory();
  DeviceBuffer buffer(device(), "kept");
  EXPECT_EQ(buffer.address(), 0u);
  buffer.resize<uint32_t>(1000);
  const VkDeviceAddress address = buffer.address();
  const uint64_t held = device().heldMemory();
  EXPECT_GE(held, before + 4000);
  buffer.resize<uint32_t>(10);
  EXPECT_EQ(buffer.bytes(), 40u);
  buffer.resize<uint32_t>(1000);
  EXPECT_EQ(buffer.address(), address);
  EXPECT_EQ(device().heldMemory(), held);
  DeviceBuffer other = std::move(buffer);
  EXPECT_EQ(other.address(), address);
  other.resize<uint32_t>(100000);
  EXPECT_GT(device().heldMemory(), held);
  other.release();
  EXPECT_EQ(device().heldMemory(), before);
}

TEST_F(VulkanDevice, KeepsToTheLimit) {
  DeviceBuffer buffer(device(), "limited"), other(device(), "other");
  buffer.resize<std::byte>(1 << 20);
  const uint64_t held = device().heldMemory();
  device().limitMemory(held);
  EXPECT_EQ(device().memoryLeft(), 0u);
  EXPECT_NO_THROW(buffer.resize<std::byte>(1 << 20));
  try {
    other.resize<std::byte>(1);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Memory);
    EXPECT_NE(std::string(error.what()).find("but only 0 bytes of the limit is left; use a lower resolution"),
              std::string::npos)
        << error.what();
  }
  EXPECT_EQ(device().heldMemory(), held);
  device().limitMemory(UINT64_MAX);
  EXPECT_NO_THROW(other.resize<std::byte>(1));
}

TEST_F(VulkanDevice, SharesScratchMemory) {
  ScratchMemory scratch(device());
  DeviceBuffer a(device(), "a", &scratch), b(device(), "b", &scratch), later(device(), "later", &scratch);
  const uint64_t before = device().heldMemory();
  a.resize<uint32_t>(1000);
  b.resize<uint32_t>(10);
  scratch.startPhase();
  later.resize<uint32_t>(100);
  EXPECT_EQ(later.address(), a.address());
  EXPECT_EQ(later.bytes(), 400u);
  EXPECT_GE(b.address() > a.address() ? b.address() - a.address() : a.address() - b.address(), 40u);
  const uint64_t held = device().heldMemory();
  EXPECT_GE(held, before + 4040);

  run([&](Commands& commands) { commands.fill(b, 1); });
  scratch.startPhase();
  later.resize<uint32_t>(500);
  EXPECT_EQ(device().heldMemory(), held);
  scratch.startPhase();
  later.resize<uint32_t>(100000);
  EXPECT_EQ(later.address(), a.address());  // Both moved.
  EXPECT_EQ(download<uint32_t>(b), std::vector<uint32_t>(10, 1));
}

TEST_F(VulkanDevice, MapsWhatTheHostShares) {
  Device plain({.guards = false});
  DeviceBuffer own(plain, "own"), upload(plain, "upload", MemoryUse::Upload);
  own.resize<uint32_t>(10);
  upload.resize<uint32_t>(10);
  EXPECT_EQ(upload.mapped<uint32_t>().size(), 10u);
  const bool isSoftware = plain.info().type == DeviceType::Software;
  EXPECT_EQ(own.mapped<uint32_t>().empty(), own.mapped<uint32_t>().data() == nullptr);
  EXPECT_TRUE(!isSoftware || own.mapped<uint32_t>().size() == 10);
}

TEST_F(VulkanDevice, RefusesMoreMemoryThanThereIs) {
  DeviceBuffer buffer(device(), "monster");
  for (const uint64_t bytes : {uint64_t{1} << 60, device().availableMemory(0) + (1U << 20)}) {
    try {
      buffer.resize<uint8_t>(bytes);
      ADD_FAILURE() << "got " << bytes << " bytes";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Memory);
      EXPECT_NE(std::string(error.what()).find("monster"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(buffer.address(), 0u);
  buffer.resize<uint8_t>(100);  // The buffer is still usable.
  EXPECT_NE(buffer.address(), 0u);
}

TEST_F(VulkanDevice, ComparesPushConstants) {
  EXPECT_THROW(Kernel<DispatchArgumentsPush>(device(), shaders::kNumberInvocations, 64), std::logic_error);
}

TEST_F(VulkanDevice, NumbersInvocationsBeyondOneDimension) {
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

TEST_F(VulkanDevice, HasSubgroupsOfTheReportedSize) {
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

TEST_F(VulkanDevice, DispatchesWhatTheDeviceCounted) {
  const uint32_t groupSize = 32;
  NumberKernel kernel(device(), shaders::kNumberInvocations, groupSize, {7});
  DispatchArguments arguments(device(), "arguments", 2);
  for (const uint32_t count : {0U, 1U, kMaxGroups * groupSize + 1}) {
    DeviceBuffer buffer(device(), "groups");
    buffer.resize<uint32_t>(3000000);
    const DeviceBuffer counted = upload<uint32_t>({count}, "count");
    run([&](Commands& commands) {
      commands.fill(buffer, 0);
      arguments.record(
          commands, 1,
          {.count = {.most = 3000000, .address = counted.address()}, .itemsPerGroup = groupSize});
      arguments.dispatch(commands, kernel,
                         {.groups = buffer.address(), .count = 3000000, .groupSize = groupSize}, 1);
    });
    const std::vector<uint32_t> groups = download<uint32_t>(buffer);
    const uint32_t all = (count + groupSize - 1) / groupSize;
    EXPECT_EQ(all == 0 ? 6 : groups[all * groupSize - 1], 7 + all - 1);
    // Dispatches over two dimensions may have more groups than needed.
    EXPECT_EQ(groups[(all + 1) * groupSize], 0u);
  }
}

TEST_F(VulkanDevice, SplitsWhatTheDeviceCounted) {
  constexpr uint32_t kSize = 16, kMost = 5, kCapacity = 30 * kSize;
  NumberKernel kernel(device(), shaders::kNumberInvocations, kSize, {1});
  DispatchArguments arguments(device(), "arguments");
  arguments.reserve(5);
  for (const uint32_t groups : {0u, 1u, 4u, 5u, 6u, 15u, 19u, 20u}) {
    DeviceBuffer numbers(device(), "groups");
    numbers.resize<uint32_t>(kCapacity);
    const DeviceBuffer counted = upload<uint32_t>({groups * kSize}, "count");
    run([&](Commands& commands) {
      commands.fill(numbers, 0);
      arguments.record(commands, 1,
                       {.count = {.most = kCapacity, .address = counted.address()},
                        .itemsPerGroup = kSize,
                        .parts = 4,
                        .mostGroups = kMost});
      for (uint32_t part = 0; part < 4; ++part)
        arguments.dispatch(
            commands, kernel,
            {.groups = numbers.address(), .count = kCapacity, .groupSize = kSize, .firstGroup = part * kMost},
            1 + part, part > 0);
    });
    expectGroups(numbers, kSize, uint64_t{groups} * kSize);
  }
}

TEST_F(VulkanDevice, SplitsWhatAGateLetsThrough) {
  constexpr uint32_t kSize = 16, kMost = 5, kCapacity = 30 * kSize;
  NumberKernel kernel(device(), shaders::kNumberInvocations, kSize, {1});
  Gate gate(device(), "gate");
  const std::vector<uint64_t> groups{0, 1, 5, 6, 20, 23};
  gate.plan(groups, kMost);
  for (const uint32_t word : {0u, 9u}) {
    const DeviceBuffer opening = upload<uint32_t>({word}, "word");
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
  const DeviceBuffer open = upload<uint32_t>({1}, "word");
  run([&](Commands& commands) {
    gate.record(commands, open.address());
    gate.dispatch(commands, kernel,
                  {.groups = numbers.address(), .count = (kMaxGroups + 1) * kSize, .groupSize = kSize}, 0);
  });
  expectGroups(numbers, kSize, uint64_t{kMaxGroups + 1} * kSize);
}

TEST_F(VulkanDevice, RunsEveryGroupOfLargePartsOnce) {
  constexpr uint32_t kSize = 8, kParts = 3;
  Kernel<CountRunsPush> kernel(device(), shaders::kCountRuns, kSize);
  for (const uint32_t most : {kMostGroups, kMaxGroups}) {
    const uint32_t groups = (kParts - 1) * most + 3, listed = groups + kParts;
    const DeviceBuffer counted = upload<uint32_t>({groups}, "count");
    DispatchArguments arguments(device(), "arguments", kParts);
    Gate gate(device(), "gate");
    gate.plan(std::array{uint64_t{groups}}, most);
    const DeviceBuffer bySize = upload(std::vector<uint32_t>(listed)),
                       byGate = upload(std::vector<uint32_t>(listed));
    run([&](Commands& commands) {
      arguments.record(
          commands, 0,
          {.count = {.most = groups, .address = counted.address()}, .parts = kParts, .mostGroups = most});
      for (uint32_t part = 0; part < kParts; ++part)
        arguments.dispatch(commands, kernel, {bySize.address(), listed, part * most}, part, part > 0);
      gate.record(commands, counted.address());
      gate.dispatch(commands, kernel, {byGate.address(), listed, 0}, 0);
    });
    std::vector<uint32_t> once(listed, kSize);
    std::fill(once.begin() + groups, once.end(), 0);
    EXPECT_EQ(download<uint32_t>(bySize), once) << most;
    EXPECT_EQ(download<uint32_t>(byGate), once) << most;
  }
}

TEST_F(VulkanDevice, RefusesPartsWhoseSurplusGroupsWouldRunTwice) {
  DispatchArguments arguments(device(), "arguments", 2);
  CommandBuffer buffer(device());
  Commands commands = buffer.begin();
  EXPECT_NO_THROW(arguments.record(commands, 0, {.count = {.most = 1}, .mostGroups = kMaxGroups + 1}));
  EXPECT_NO_THROW(
      arguments.record(commands, 0, {.count = {.most = 1}, .parts = 2, .mostGroups = kMaxGroups}));
  EXPECT_THROW(
      arguments.record(commands, 0, {.count = {.most = 1}, .parts = 2, .mostGroups = kMaxGroups + 1}),
      std::logic_error);
  Gate gate(device(), "gate");
  EXPECT_NO_THROW(gate.plan(std::array{uint64_t{kMaxGroups} + 1}, kMaxGroups + 1));
  EXPECT_NO_THROW(gate.plan(std::array{uint64_t{kMaxGroups} + 1}, kMaxGroups));
  EXPECT_THROW(gate.plan(std::array{uint64_t{kMaxGroups} + 2}, kMaxGroups + 1), std::logic_error);
}

TEST_F(VulkanDevice, TimesStagesFrameAfterFrame) {
  const DeviceBuffer buffer = upload(std::vector<uint32_t>(100000));
  CommandBuffer own(device());
  const uint64_t held = device().heldMemory();
  double end = 0.0;
  for (uint32_t frame = 0; frame < 100; ++frame) {
    Commands commands = own.begin();
    commands.startStage("one");
    commands.fill(buffer, frame);
    commands.stopStage();
    commands.startStage("two");
    commands.fill(buffer, frame + 1);
    commands.stopStage();
    const auto begin = std::chrono::steady_clock::now();
    own.submitAndWait();
    const std::chrono::duration<double, std::milli> all = std::chrono::steady_clock::now() - begin;
    if (device().limits().timestampPeriod == 0) continue;
    const double began = own.times().front().start;
    const std::span<const StageTime> times = own.times();  // Read twice, it is the same.
    ASSERT_EQ(times.size(), 2u);
    EXPECT_EQ(times[0].start, began);
    if (frame == 0) {
      EXPECT_EQ(began, 0.0);
    }
    EXPECT_GE(began, end);
    end = times[1].start + times[1].milliseconds;
    EXPECT_STREQ(times[0].name, "one");
    EXPECT_STREQ(times[1].name, "two");
    EXPECT_GE(times[0].milliseconds, 0.0);
    EXPECT_GE(times[1].start - times[0].start, times[0].milliseconds - 1e-3);
    EXPECT_LE(times[1].start + times[1].milliseconds - times[0].start, 1.01 * all.count() + 0.1)
        << "within the time of the host's clock";
  }
  EXPECT_EQ(device().heldMemory(), held);
  EXPECT_EQ(download<uint32_t>(buffer).back(), 100u);
}

/// A device made as a caller would make it.
struct Foreign {
  Foreign() {
    borrowed.instance = instance.handle();
    borrowed.physical = physicalDevices(instance.handle()).front();
    borrowed.queueFamily = computeFamily(borrowed.physical).value();
    const float priority = 1.0F;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = borrowed.queueFamily,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    Features features;
    setRequired(features);
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &features.v10,
                                  .queueCreateInfoCount = 1,
                                  .pQueueCreateInfos = &queue};
    check(vkCreateDevice(borrowed.physical, &info, nullptr, &borrowed.device), "making a device");
    vkGetDeviceQueue(borrowed.device, borrowed.queueFamily, 0, &borrowed.queue);
  }
  ~Foreign() { vkDestroyDevice(borrowed.device, nullptr); }
  Foreign(const Foreign&) = delete;
  Foreign& operator=(const Foreign&) = delete;

  std::string messages;
  Instance instance{isValidated() ? Validation::On : Validation::Off,
                    [this](std::string_view message) { messages += message; }};
  DeviceHandles borrowed;
};

TEST_F(VulkanDevice, NumbersInvocationsAcrossDispatches) {
  for (const uint32_t groupSize : {64u, 128u})
    for (const uint64_t count : {uint64_t{kMostInvocations}, uint64_t{kMostInvocations} + 1,
                                 3 * uint64_t{kMostInvocations} + 1000}) {
      const DeviceBuffer numbers = upload(std::vector<uint32_t>(count, UINT32_MAX));
      NumberKernel kernel(device(), shaders::kNumberInvocations, groupSize);
      const NumberInvocationsPush push{
          .groups = numbers.address(), .count = uint32_t(count), .groupSize = groupSize};
      run([&](Commands& commands) { commands.dispatch(kernel, push, count); });
      const std::vector<uint32_t> found = download<uint32_t>(numbers);
      for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(found[i], i / groupSize) << count;
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

TEST_F(VulkanDevice, PausesWhenMuchWorkIsRecorded) {
  constexpr uint64_t kMostSubmitted = uint64_t{1} << 27, kCount = uint64_t{1} << 24;
  DeviceBuffer numbers(device(), "numbers");
  numbers.resize<uint32_t>(kCount);
  NumberKernel kernel(device(), shaders::kNumberInvocations, 128);
  const NumberInvocationsPush push{.groups = numbers.address(), .count = kCount, .groupSize = 128};
  const auto pausesAfter = [&](uint64_t dispatches) {
    CommandBuffer buffer(device());
    Restarts restarts(buffer);
    for (uint64_t d = 0; d < dispatches; ++d) restarts.commands().dispatch(kernel, push, kCount);
    restarts.commands().report(0.25);
    buffer.submitAndWait();
    EXPECT_EQ(restarts.progress, std::vector<double>{0.25});
    return restarts.count;
  };
  EXPECT_EQ(pausesAfter(kMostSubmitted / kCount), 0);
  EXPECT_EQ(pausesAfter(kMostSubmitted / kCount + 1), 1);
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

PFN_vkGetPhysicalDeviceProperties2 realProperties = nullptr;
VkDeviceSize toldBufferSize = 0, toldAllocationSize = 0;

/// Calls the driver's function, then lowers or raises limits.
VKAPI_ATTR void VKAPI_CALL tellOtherLimits(VkPhysicalDevice device, VkPhysicalDeviceProperties2* properties) {
  realProperties(device, properties);
  for (auto* next = static_cast<VkBaseOutStructure*>(properties->pNext); next; next = next->pNext) {
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES)
      reinterpret_cast<VkPhysicalDeviceVulkan11Properties*>(next)->maxMemoryAllocationSize =
          toldAllocationSize;
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES)
      reinterpret_cast<VkPhysicalDeviceVulkan13Properties*>(next)->maxBufferSize = toldBufferSize;
  }
}

/// Returns a device that tells these limits.
Device deviceTelling(VkDeviceSize bufferSize, VkDeviceSize allocationSize) {
  toldBufferSize = bufferSize;
  toldAllocationSize = allocationSize;
  const ReplacedEntry replaced(vkGetPhysicalDeviceProperties2, tellOtherLimits);
  realProperties = replaced.real();
  return Device({.validation = Validation::Off});
}

TEST_F(VulkanDevice, KeepsBuffersBelowEveryLimit) {
  constexpr VkDeviceSize kMebi = 1 << 20, kHuge = VkDeviceSize{1} << 40;
  for (const auto& [bufferSize, allocationSize] : {std::pair(kMebi, kHuge), std::pair(kHuge, kMebi)}) {
    Device small = deviceTelling(bufferSize, allocationSize);
    DeviceBuffer buffer(small, "distance");
    buffer.resize<std::byte>(kMebi);
    EXPECT_EQ(buffer.bytes(), kMebi);
    try {
      buffer.resize<std::byte>(kMebi + 1);
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Memory);
      EXPECT_STREQ(error.what(),
                   "the device's buffer 'distance' needs 2 MiB, but one buffer can have at most 1 MiB; use a "
                   "lower resolution or another device");
    }
  }
  // Kernels number 2^31 elements of four bytes.
  EXPECT_EQ(deviceTelling(kHuge, kHuge).limits().bufferSize, VkDeviceSize{1} << 33);
}

PFN_vkEnumerateDeviceExtensionProperties realExtensions = nullptr;
PFN_vkCreateDevice realCreateDevice = nullptr;
std::vector<std::string> enabledExtensions;

/// Lists VK_KHR_portability_subset besides the driver's extensions.
VKAPI_ATTR VkResult VKAPI_CALL listPortability(VkPhysicalDevice device, const char* layer, uint32_t* count,
                                               VkExtensionProperties* properties) {
  if (!properties) {
    const VkResult result = realExtensions(device, layer, count, nullptr);
    ++*count;
    return result;
  }
  uint32_t others = *count - 1;
  const VkResult result = realExtensions(device, layer, &others, properties);
  properties[others] = {"VK_KHR_portability_subset", 1};
  *count = others + 1;
  return result;
}

/// Makes a device without the extensions that the caller enables, and notes them.
VKAPI_ATTR VkResult VKAPI_CALL noteExtensions(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                              const VkAllocationCallbacks* allocator, VkDevice* device) {
  enabledExtensions.assign(info->ppEnabledExtensionNames,
                           info->ppEnabledExtensionNames + info->enabledExtensionCount);
  VkDeviceCreateInfo plain = *info;
  plain.enabledExtensionCount = 0;
  return realCreateDevice(physical, &plain, allocator, device);
}

TEST_F(VulkanDevice, EnablesThePortabilitySubsetOfADeviceThatHasIt) {
  const ReplacedEntry created(vkCreateDevice, noteExtensions);
  realCreateDevice = created.real();
  const Device conformant({.validation = Validation::Off});
  EXPECT_EQ(enabledExtensions, std::vector<std::string>{});
  const ReplacedEntry listed(vkEnumerateDeviceExtensionProperties, listPortability);
  realExtensions = listed.real();
  const Device portable({.validation = Validation::Off});
  EXPECT_EQ(enabledExtensions, std::vector<std::string>{"VK_KHR_portability_subset"});
}

/// Writes copies of the installed drivers' manifests that name each driver as one of a subset of Vulkan.
/// Returns their paths, separated by colons.
std::string portabilityManifests(const std::filesystem::path& folder) {
  const std::filesystem::path installed = "/usr/share/vulkan/icd.d";
  if (!std::filesystem::exists(installed)) return "";
  std::string paths;
  for (const auto& manifest : std::filesystem::directory_iterator(installed)) {
    std::string text = readBytes(manifest.path());
    const std::string driver = "\"ICD\": {";
    const size_t at = text.find(driver);
    if (at == std::string::npos) continue;
    text.insert(at + driver.size(), "\"is_portability_driver\": true,");
    const std::filesystem::path path = folder / manifest.path().filename();
    std::ofstream(path) << text;
    paths += (paths.empty() ? "" : ":") + path.string();
  }
  return paths;
}

TEST_F(VulkanDevice, SeesDriversOfASubsetOfVulkan) {
  const TemporaryFolder folder;
  const std::string manifests = portabilityManifests(folder.path());
  if (manifests.empty()) GTEST_SKIP() << "no manifests of drivers";
  // Newer loaders prefer the first variable, older ones know only the second.
  const ScopedVariable drivers("VK_DRIVER_FILES", manifests), icds("VK_ICD_FILENAMES", manifests);
  VkInstance plain = VK_NULL_HANDLE;
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  if (vkCreateInstance(&info, nullptr, &plain) == VK_SUCCESS) {
    vkDestroyInstance(plain, nullptr);
    GTEST_SKIP() << "the loader hides no drivers";
  }
  const Instance instance;
  EXPECT_FALSE(physicalDevices(instance.handle()).empty());
}

TEST_F(VulkanDevice, WorksOnACallersDevice) {
  Foreign foreign;
  {
    Device device(foreign.borrowed);
    DeviceBuffer buffer(device, "groups", MemoryUse::ReadBack);
    buffer.resize<uint32_t>(100);
    NumberKernel kernel(device, shaders::kNumberInvocations, 10);
    CommandBuffer own(device);
    Commands commands = own.begin();
    commands.dispatch(kernel, {.groups = buffer.address(), .count = 100, .groupSize = 10}, 100);
    own.submitAndWait();
    EXPECT_EQ(buffer.mapped<uint32_t>()[99], 9u);
  }
  EXPECT_EQ(foreign.messages, "");
}

}  // namespace
}  // namespace raymap::vulkan
