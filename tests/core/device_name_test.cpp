#include "method/device_name.h"

#include <gtest/gtest.h>

namespace raymap {
namespace {

using Kind = DeviceName::Kind;

TEST(DeviceName, IsOneOfFour) {
  const struct {
    const char* text;
    Kind kind;
    std::optional<size_t> index;
  } names[] = {{"auto", Kind::Auto, {}},
               {"cpu", Kind::Cpu, {}},
               {"vulkan", Kind::Vulkan, {}},
               {"vulkan:0", Kind::Vulkan, 0},
               {"vulkan:12", Kind::Vulkan, 12}};
  for (const auto& [text, kind, index] : names) {
    const std::optional<DeviceName> name = parseDeviceName(text);
    ASSERT_TRUE(name) << text;
    EXPECT_EQ(name->kind, kind) << text;
    EXPECT_EQ(name->index, index) << text;
  }
}

TEST(DeviceName, IsNoOtherText) {
  for (const char* text :
       {"", "gpu", "Auto", "auto ", " cpu", "cpu:0", "vulkan:", "vulkan:x", "vulkan:-1", "vulkan:+1",
        "vulkan: 1", "vulkan:1x", "vulkan:0x1", "vulkan:1.0", "vulkan0", "vulkan:99999999999999999999999"})
    EXPECT_FALSE(parseDeviceName(text)) << text;
}

}  // namespace
}  // namespace raymap
