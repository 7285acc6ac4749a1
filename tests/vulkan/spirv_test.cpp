#include "vulkan/device/spirv.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <vector>

#include "shaders/number_invocations.h"
#include "shaders/number_invocations_spv.h"

namespace raymap::vulkan {
namespace {

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

}  // namespace
}  // namespace raymap::vulkan
