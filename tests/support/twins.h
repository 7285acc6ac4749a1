#pragma once

// Fixture of tests that run a stage on the CPU and, if built, on Vulkan.

#include <gtest/gtest.h>

#include <string>

#ifdef RAYMAP_TEST_VULKAN
#include "vulkan_device.h"
#endif

namespace raymap {

enum class Twin { Cpu, Vulkan };

#ifdef RAYMAP_TEST_VULKAN
using TwinTestBase = vulkan::VulkanTest;
#else
using TwinTestBase = ::testing::Test;
#endif

class TwinTest : public TwinTestBase, public ::testing::WithParamInterface<Twin> {
 protected:
  static bool isOnCpu() { return GetParam() == Twin::Cpu; }
  void SetUp() override {
    if (!isOnCpu()) TwinTestBase::SetUp();
  }
  void TearDown() override {
    if (!isOnCpu()) TwinTestBase::TearDown();
  }
};

// For INSTANTIATE_TEST_SUITE_P.
inline auto allTwins() {
#ifdef RAYMAP_TEST_VULKAN
  return ::testing::Values(Twin::Cpu, Twin::Vulkan);
#else
  return ::testing::Values(Twin::Cpu);
#endif
}
inline std::string twinName(const ::testing::TestParamInfo<Twin>& info) {
  return info.param == Twin::Cpu ? "Cpu" : "Vulkan";
}

}  // namespace raymap
