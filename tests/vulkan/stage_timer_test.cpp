#include "vulkan/device/stage_timer.h"

#include <chrono>
#include <vector>

#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

TEST(TickCounter, CountsOnWhenTimestampsBeginAgain) {
  TickCounter counter(36);
  EXPECT_EQ(counter.advanceTo(0xFFFFFFFF0), 0u);
  EXPECT_EQ(counter.advanceTo(0xFFFFFFFFF), 15u);
  EXPECT_EQ(counter.advanceTo(0x000000001), 17u);
  EXPECT_EQ(counter.advanceTo(0x000000001), 17u);
  EXPECT_EQ(counter.advanceTo(0xFFFFFFFF0), 0x1000000000u);
  EXPECT_EQ(counter.advanceTo(0x000000000), 0x1000000010u);
}

TEST(TickCounter, IgnoresBitsThatDoNotCount) {
  TickCounter counter(36);
  EXPECT_EQ(counter.advanceTo(0xABC0000000000005), 0u);
  EXPECT_EQ(counter.advanceTo(0x0120000000000008), 3u);
  EXPECT_EQ(counter.advanceTo(0x0000001000000009), 4u);
}

TEST(TickCounter, CountsAllBits) {
  TickCounter counter(64);
  EXPECT_EQ(counter.advanceTo(0xFFFFFFFFFFFFFFFE), 0u);
  EXPECT_EQ(counter.advanceTo(3), 5u);
  EXPECT_EQ(counter.advanceTo(0x8000000000000003), 0x8000000000000005u);
}

class VulkanStageTimer : public VulkanTest {};

TEST_F(VulkanStageTimer, TimesStagesFrameAfterFrame) {
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

}  // namespace
}  // namespace raymap::vulkan
