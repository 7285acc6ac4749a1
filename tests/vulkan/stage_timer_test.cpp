#include "vulkan/device/stage_timer.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace raymap::vulkan
