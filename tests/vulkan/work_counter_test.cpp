// The counters of tests/kernels, which gpu_bench --count uses, on kernels whose work is known.

#include "counters/work_counter.h"

#include "shaders/counted_loops.h"
#include "shaders/counted_loops_spv.h"
#include "shaders/counted_vectors_spv.h"
#include "vulkan/device/dispatch_limits.h"
#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

constexpr uint32_t kGroup = 64;

class VulkanWorkCounter : public VulkanTest {
 protected:
  void SetUp() override {
    VulkanTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    counter_ = std::make_unique<WorkCounter>();
    // A device makes equal kernels once, but each counter changes its own.
    device_.emplace(
        DeviceOptions{.message = [](std::string_view message) { ADD_FAILURE() << message; }, .guards = true});
    counter_->start(device());
    loops_.emplace(device(), shaders::kCountedLoops, kGroup);
    values_ = DeviceBuffer(device(), "values");
    sums_ = DeviceBuffer(device(), "sums");
  }

  void TearDown() override {
    loops_.reset();
    values_.release();
    sums_.release();
    if (counter_) counter_->stop();
    device_.reset();
    counter_.reset();
    VulkanTest::TearDown();
  }

  Device& device() { return *device_; }

  template <class Work>
  void run(Work&& record) {
    CommandBuffer buffer(device());
    Commands commands = buffer.begin();
    record(commands);
    buffer.submitAndWait();
    EXPECT_EQ(device().guards()->damaged(), "");
  }

  CountedLoopsPush push(uint32_t first, uint32_t more, uint32_t invocations) {
    values_.resize<uint32_t>(first + uint64_t{more} * (invocations - 1));
    sums_.resize<uint32_t>(invocations);
    return {.values = values_.address(), .sums = sums_.address(), .first = first, .more = more};
  }

  /// Returns the work of invocations with `first` iterations, and `more` for each invocation before.
  WorkCounters workOf(uint32_t first, uint32_t more, uint32_t invocations) {
    const CountedLoopsPush loops = push(first, more, invocations);
    counter_->clear();
    run([&](Commands& commands) { commands.dispatch(*loops_, loops, invocations); });
    EXPECT_EQ(counter_->commands().size(), 1u);
    return counter_->commands().front().work;
  }

  std::unique_ptr<WorkCounter> counter_;
  std::optional<Device> device_;
  std::optional<Kernel<CountedLoopsPush>> loops_;
  DeviceBuffer values_, sums_;
};

TEST_F(VulkanWorkCounter, CountsAllPartsOfASubmission) {
  const WorkCounters small = workOf(3, 0, kGroup), large = workOf(5, 0, 2 * kGroup);
  const CountedLoopsPush second = push(5, 0, 2 * kGroup);  // Its memory is large enough for the first, too.
  CountedLoopsPush first = second;
  first.first = 3;
  counter_->clear();
  CommandBuffer buffer(device());
  Commands commands = buffer.begin();
  commands.dispatch(*loops_, first, kGroup);
  buffer.submitPart(commands);
  commands.dispatch(*loops_, second, 2 * kGroup);
  buffer.waitForParts();  // The second dispatch is not done, so nothing is read.
  buffer.submitAndWait();
  ASSERT_EQ(counter_->commands().size(), 2u);
  EXPECT_EQ(counter_->commands()[0].work.operations, small.operations);
  EXPECT_EQ(counter_->commands()[1].work.operations, large.operations);
}

TEST_F(VulkanWorkCounter, CountsTheBytesOfVectors) {
  Kernel<CountedLoopsPush> vectors(device(), shaders::kCountedVectors, kGroup);
  for (DeviceBuffer* buffer : {&values_, &sums_}) buffer->resize<float>(4 * kGroup);
  const CountedLoopsPush both{.values = values_.address(), .sums = sums_.address()};
  counter_->clear();
  run([&](Commands& commands) { commands.dispatch(vectors, both, kGroup); });
  ASSERT_EQ(counter_->commands().size(), 1u);
  EXPECT_EQ(counter_->commands()[0].work.bytesRead, 16u * kGroup);
  EXPECT_EQ(counter_->commands()[0].work.bytesWritten, 16u * kGroup);
}

TEST_F(VulkanWorkCounter, CountsBytesAndRounds) {
  const WorkCounters work = workOf(3, 2, kGroup);
  EXPECT_EQ(work.bytesRead, 4u * (3 * kGroup + 2 * (kGroup * (kGroup - 1) / 2)));
  EXPECT_EQ(work.bytesWritten, 4u * kGroup);
  EXPECT_EQ(work.mostRounds, 3 + 2 * (kGroup - 1));
}

TEST_F(VulkanWorkCounter, CountsOperationsOfEveryIteration) {
  const WorkCounters none = workOf(0, 0, kGroup), one = workOf(1, 0, kGroup), some = workOf(0, 1, kGroup);
  const uint32_t apart = none.longest, iteration = one.longest - none.longest;
  // An addition for the sum, one for the index and its comparison, the branch, the address (2), the load.
  EXPECT_EQ(iteration, 7u);
  EXPECT_EQ(none.operations, kGroup * uint64_t{apart});
  EXPECT_EQ(some.longest, apart + (kGroup - 1) * iteration);
  EXPECT_EQ(some.operations, kGroup * apart + kGroup * (kGroup - 1) / 2 * iteration);
  EXPECT_EQ(none.steppedOperations, none.operations);
  uint64_t stepped = 0;
  const uint32_t lanes = std::min(device().limits().maxSubgroupSize, kGroup);
  for (uint32_t end = lanes; end <= kGroup; end += lanes) stepped += lanes * (apart + (end - 1) * iteration);
  EXPECT_EQ(some.steppedOperations, stepped);
}

TEST_F(VulkanWorkCounter, CountsBeyond32Bits) {
  constexpr uint32_t kInvocations = 1U << 15, kIterations = 30000;
  const uint64_t apart = workOf(0, 0, kGroup).longest;
  const WorkCounters work = workOf(kIterations, 0, kInvocations);
  EXPECT_EQ(work.operations, kInvocations * (apart + 7 * uint64_t{kIterations}));
  EXPECT_EQ(work.steppedOperations, work.operations);
  EXPECT_EQ(work.bytesRead, 4 * uint64_t{kInvocations} * kIterations);
}

TEST_F(VulkanWorkCounter, CountsEachDispatchByItself) {
  const uint64_t alone = workOf(1, 0, kGroup).operations;
  const CountedLoopsPush loops = push(1, 0, kGroup);
  counter_->clear();
  run([&](Commands& commands) {
    for (int i = 0; i < 3; ++i) commands.dispatch(*loops_, loops, kGroup);
  });
  ASSERT_EQ(counter_->commands().size(), 3u);
  for (const CountedCommand& command : counter_->commands()) EXPECT_EQ(command.work.operations, alone);
}

TEST_F(VulkanWorkCounter, TellsPartsOfADispatch) {
  constexpr uint32_t kTwoDispatches = 2 * kMaxGroups * kGroup;
  const CountedLoopsPush loops = push(1, 0, kTwoDispatches);
  CountedLoopsPush others = loops;
  others.first = 0;
  counter_->clear();
  run([&](Commands& commands) {
    commands.concurrent([&] {
      commands.dispatch(*loops_, loops, kTwoDispatches);
      commands.dispatch(*loops_, others, kGroup);
    });
    commands.dispatch(*loops_, others, kGroup);
  });
  std::vector<bool> isMore;
  for (const CountedCommand& command : counter_->commands()) isMore.push_back(command.isMore);
  EXPECT_EQ(isMore, (std::vector<bool>{false, true, false, false}));
}

TEST_F(VulkanWorkCounter, NumbersStepsAndSubmissions) {
  const CountedLoopsPush loops = push(1, 0, 3 * kGroup);
  DispatchArguments arguments(device(), "arguments");
  arguments.reserve({.most = 3 * kGroup, .itemsPerGroup = kGroup});
  const DeviceBuffer count = upload(std::vector<uint32_t>{3 * kGroup}, "count");
  counter_->clear();
  counter_->setStage("first");
  run([&](Commands& commands) {
    commands.fill(values_, 0);
    commands.concurrent([&] {
      arguments.record(commands, count.address());
      commands.dispatch(*loops_, loops, kGroup + 1);
    });
  });
  counter_->setStage("second");
  run([&](Commands& commands) { arguments.dispatch(commands, *loops_, loops); });
  const std::vector<CountedCommand>& commands = counter_->commands();
  ASSERT_EQ(commands.size(), 4u);
  const char* const names[] = {"fill", "dispatch_arguments", "unknown shader", "unknown shader"};
  const uint64_t groups[] = {0, 1, 2, 3};
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(commands[i].name, names[i]);
    EXPECT_EQ(commands[i].groups, groups[i]);
    EXPECT_EQ(commands[i].stage, i < 3 ? "first" : "second");
    EXPECT_EQ(commands[i].submission, i < 3 ? 0u : 1u);
  }
  EXPECT_LT(commands[0].step, commands[1].step);
  EXPECT_EQ(commands[1].step, commands[2].step);
  EXPECT_LT(commands[2].step, commands[3].step);
  for (const CountedCommand& command : commands) EXPECT_FALSE(command.isMore);
  EXPECT_EQ(commands[0].work.bytesWritten, 4u);
  // Both buffers of the loops, with their guards behind.
  EXPECT_EQ(commands[3].touchableBytes, 4u + 4u * 3 * kGroup + 2 * Guards::kBytes);
}

class VulkanCommandTimes : public VulkanTest {};

TEST_F(VulkanCommandTimes, AddUpToThatOfTheStage) {
  WorkCounter timer(Measured::Time);
  Device device({.guards = true});
  timer.start(device);
  DeviceBuffer values(device, "values"), sums(device, "sums");
  values.resize<uint32_t>(1000);
  sums.resize<uint32_t>(kGroup);
  DispatchArguments arguments(device, "arguments");
  arguments.reserve({.most = kGroup, .itemsPerGroup = kGroup});
  Kernel<CountedLoopsPush> loops(device, shaders::kCountedLoops, kGroup);
  const CountedLoopsPush push{.values = values.address(), .sums = sums.address(), .first = 1000, .more = 0};
  CommandBuffer buffer(device);
  for (int turn = 0; turn < 2; ++turn) {
    timer.clear();
    buffer.begin().fill(values, 5);  // Dropped.
    Commands commands = buffer.begin();
    commands.fill(values, turn + 1);
    commands.startStage("loops");
    arguments.record(commands, values.address());
    commands.dispatch(loops, push, kGroup);
    arguments.dispatch(commands, loops, push);
    commands.stopStage();
    buffer.submitAndWait();
    const std::vector<CountedCommand>& found = timer.commands();
    ASSERT_EQ(found.size(), 4u);
    const char* const names[] = {"fill", "dispatch_arguments", "unknown shader", "unknown shader"};
    double sum = 0.0;
    for (size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].name, names[i]);
      EXPECT_EQ(found[i].work.operations, 0u);
      EXPECT_GE(found[i].milliseconds, 0.0);
      if (i > 0) sum += found[i].milliseconds;
    }
    EXPECT_GT(found[2].milliseconds, 0.0);
    // The stage begins after the end of the fill, and ends after the last command.
    const double lasting = buffer.times().front().milliseconds;
    EXPECT_GE(lasting, found[2].milliseconds + found[3].milliseconds);
    EXPECT_GT(sum, 0.0);
    Probe probe(device);
    for (const uint32_t value : probe.download<uint32_t>(sums)) EXPECT_EQ(value, 1000u * (turn + 1));
    timer.clear();
  }
  timer.stop();
}

}  // namespace
}  // namespace raymap::vulkan
