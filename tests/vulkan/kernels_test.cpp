// The capabilities that kernels ask of a device, read from their SPIR-V.

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "method/gpu_plug_in.h"
#include "vulkan/device/features.h"
#include "vulkan/device/spirv.h"
// Must follow Vulkan's declarations.
#include "shaders/raymap_vulkan_all.h"

namespace raymap::vulkan {
namespace {

// SPIR-V specification, §3.
enum Op : uint32_t {
  OpName = 5,
  OpCapability = 17,
  OpTypeFloat = 22,
  OpConstant = 43,
  OpFunction = 54,
  OpVariable = 59,
  OpAccessChain = 65,
  OpInBoundsAccessChain = 66,
  OpPtrAccessChain = 67,
  OpInBoundsPtrAccessChain = 70,
  OpDecorate = 71,
  OpFAdd = 129,
  OpFSub = 131,
  OpFMul = 133
};
constexpr uint32_t kDecorationNoContraction = 42;
constexpr uint32_t kStoragePushConstant = 9;

enum Capability : uint32_t {
  CapabilityShader = 1,
  Int64 = 11,
  GroupNonUniform = 61,
  GroupNonUniformVote = 62,
  GroupNonUniformArithmetic = 63,
  GroupNonUniformBallot = 64,
  PhysicalStorageBufferAddresses = 5347
};

std::set<uint32_t> capabilitiesOf(const Shader& shader) {
  std::set<uint32_t> capabilities;
  forEachInstruction(shader.code, [&](std::span<const uint32_t> words) {
    if (opOf(words) == OpCapability) capabilities.insert(words[1]);
  });
  return capabilities;
}

TEST(Kernels, AskForNoOtherCapabilitiesThanTheDeviceIsCheckedFor) {
  const std::map<uint32_t, VkSubgroupFeatureFlags> subgroupOperations = {
      {GroupNonUniform, VK_SUBGROUP_FEATURE_BASIC_BIT},
      {GroupNonUniformVote, VK_SUBGROUP_FEATURE_VOTE_BIT},
      {GroupNonUniformArithmetic, VK_SUBGROUP_FEATURE_ARITHMETIC_BIT},
      {GroupNonUniformBallot, VK_SUBGROUP_FEATURE_BALLOT_BIT}};
  VkSubgroupFeatureFlags used = 0;
  for (const Shader& shader : shaders::kAll)
    for (const uint32_t capability : capabilitiesOf(shader)) {
      if (const auto operation = subgroupOperations.find(capability); operation != subgroupOperations.end())
        used |= operation->second;
      else
        EXPECT_TRUE(capability == CapabilityShader || capability == Int64 ||
                    capability == PhysicalStorageBufferAddresses)
            << shader.name << " needs capability " << capability;
    }
  EXPECT_EQ(used, requiredSubgroupOperations());
  Features features;
  setRequired(features);
  EXPECT_EQ(features.v10.features.shaderInt64, VK_TRUE);
  EXPECT_EQ(features.v10.features.shaderFloat64, VK_FALSE);
}

TEST(Kernels, HaveAHashThatChangesWithEachOfThem) {
  ASSERT_NE(gpuPlugIn(), nullptr);
  const uint64_t hash = hashOf(shaders::kAll);
  EXPECT_EQ(gpuPlugIn()->kernelHash(), hash);
  const std::vector<Shader> all(std::begin(shaders::kAll), std::end(shaders::kAll));
  for (size_t s = 0; s < all.size(); ++s) {
    std::vector<uint32_t> code(all[s].code.begin(), all[s].code.end());
    code.back() ^= 1u << 31;
    std::vector<Shader> changed = all;
    changed[s].code = code;
    EXPECT_NE(hashOf(changed), hash) << all[s].name;
  }
  std::vector<Shader> renamed = all;
  std::swap(renamed[0].name, renamed[1].name);
  EXPECT_NE(hashOf(renamed), hash);
}

TEST(Kernels, HaveNoNumbersOfDoublePrecision) {
  size_t floats = 0;
  for (const Shader& shader : shaders::kAll)
    forEachInstruction(shader.code, [&](std::span<const uint32_t> words) {
      if (opOf(words) != OpTypeFloat) return;
      EXPECT_EQ(words[2], 32u) << shader.name;
      ++floats;
    });
  EXPECT_GT(floats, 20u);
}

TEST(Kernels, NameTheSubgroupOperationsThatADeviceLacks) {
  const VkSubgroupFeatureFlags all = requiredSubgroupOperations();
  constexpr VkShaderStageFlags kCompute = VK_SHADER_STAGE_COMPUTE_BIT;
  EXPECT_TRUE(missingSubgroupOperations(all, kCompute).empty());
  using Names = std::vector<std::string>;
  EXPECT_EQ(
      missingSubgroupOperations(all & ~VkSubgroupFeatureFlags{VK_SUBGROUP_FEATURE_ARITHMETIC_BIT}, kCompute),
      Names{"subgroup operations 'arithmetic' in compute shaders"});
  EXPECT_EQ(
      missingSubgroupOperations(all & ~VkSubgroupFeatureFlags{VK_SUBGROUP_FEATURE_BALLOT_BIT}, kCompute),
      Names{"subgroup operations 'ballot' in compute shaders"});
  EXPECT_EQ(missingSubgroupOperations(all, VK_SHADER_STAGE_FRAGMENT_BIT).size(), 3u);
}

/// Counts the sums and products of floats in a function of a shader, and those of them that drivers may
/// contract.
struct Arithmetic {
  size_t all = 0;
  size_t contractable = 0;
};

/// Returns the arithmetic in each function, by the function's name without its parameters.
std::map<std::string, Arithmetic> arithmeticOf(const Shader& shader) {
  std::map<uint32_t, std::string> names;
  std::set<uint32_t> precise;
  std::map<std::string, Arithmetic> functions;
  std::string function;
  forEachInstruction(shader.code, [&](std::span<const uint32_t> words) {
    const uint32_t op = opOf(words);
    if (op == OpName) {
      const char* text = reinterpret_cast<const char*>(words.data() + 2);
      const std::string name(text, strnlen(text, 4 * (words.size() - 2)));
      names[words[1]] = name.substr(0, name.find('('));
    }
    if (op == OpDecorate && words[2] == kDecorationNoContraction) precise.insert(words[1]);
    if (op == OpFunction) function = names[words[2]];
    if (op != OpFAdd && op != OpFSub && op != OpFMul) return;
    ++functions[function].all;
    if (!precise.contains(words[2])) ++functions[function].contractable;
  });
  return functions;
}

TEST(Kernels, ForbidDriversToContractWhatMustBeRounded) {
  std::map<std::string, std::set<std::string>> rounded = {
      {"surface_tree_leaves", {"exactSum", "renormalized", "exactProduct", "pairSum", "pairProduct"}},
      {"distance_transform", {"fractionOf"}},
      {"cell_distance", {"dotExactly", "crossExactly"}}};
  for (const Shader& shader : shaders::kAll) {
    const auto functions = arithmeticOf(shader);
    for (const std::string& name : rounded[std::string(shader.name)]) {
      const auto function = functions.find(name);
      ASSERT_NE(function, functions.end()) << name << " of " << shader.name;
      EXPECT_GT(function->second.all, 0u) << name;
      EXPECT_EQ(function->second.contractable, 0u) << name << " of " << shader.name;
    }
  }
}

/// Access chains into the push constants of a module, and those of them with an index that is no constant.
struct PushReads {
  std::vector<std::span<const uint32_t>> all;
  size_t variable = 0;
};

PushReads pushReadsOf(std::span<const uint32_t> code) {
  constexpr size_t kFirstIndex = 4;
  PushReads reads;
  std::set<uint32_t> constants, pointers;
  forEachInstruction(code, [&](std::span<const uint32_t> words) {
    const uint32_t op = opOf(words);
    if (op == OpConstant) constants.insert(words[2]);
    if (op == OpVariable && words[3] == kStoragePushConstant) pointers.insert(words[2]);
    const std::set<uint32_t> chains{OpAccessChain, OpInBoundsAccessChain, OpPtrAccessChain,
                                    OpInBoundsPtrAccessChain};
    if (!chains.contains(op) || !pointers.contains(words[3])) return;
    pointers.insert(words[2]);
    reads.all.push_back(words);
    for (const uint32_t index : words.subspan(kFirstIndex))
      reads.variable += constants.contains(index) ? 0 : 1;
  });
  return reads;
}

// Vulkan wants an index that is the same in all invocations. AMD's compiler takes that of the first one for
// the others, which no software driver shows.
TEST(Kernels, ReadPushConstantsAtConstantPlaces) {
  for (const Shader& shader : shaders::kAll) {
    const PushReads reads = pushReadsOf(shader.code);
    EXPECT_EQ(reads.variable, 0u) << shader.name;
    ASSERT_FALSE(reads.all.empty()) << shader.name;
    std::vector<uint32_t> code(shader.code.begin(), shader.code.end());
    const std::span<const uint32_t> last = reads.all.back();
    code[static_cast<size_t>(&last.back() - shader.code.data())] = last[2];  // Its own result.
    EXPECT_EQ(pushReadsOf(code).variable, 1u) << shader.name;
  }
}

}  // namespace
}  // namespace raymap::vulkan
