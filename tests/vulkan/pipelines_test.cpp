#include "vulkan/device/pipelines.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <fstream>
#include <set>

#include "counters/vulkan_entry.h"
#include "environment.h"
#include "files.h"
#include "shaders/number_invocations.h"
#include "shaders/number_invocations_spv.h"
#include "shaders/wave_vertices_spv.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::byte>;

Bytes someBytes(size_t count) {
  Bytes bytes(count);
  for (size_t b = 0; b < count; ++b) bytes[b] = std::byte(b * b % 251);
  return bytes;
}

constexpr DriverIdentity kIdentity{
    .vendor = 0x10DE, .device = 0x2330, .driverVersion = 7, .cacheId = {1, 2, 3}};

TEST(PipelineCacheFile, KeepsWhatTheDriverCompiled) {
  const TemporaryFolder folder;
  const ScopedVariable cache("RAYMAP_CACHE", folder.path().string());
  const PipelineCacheFile file(kIdentity);
  EXPECT_EQ(file.name(), "vulkan-pipelines-10de-2330.bin");
  EXPECT_EQ(file.read(), Bytes());
  file.write(someBytes(32));  // A header alone.
  EXPECT_FALSE(fs::exists(folder.path() / file.name()));
  for (const size_t count : {5000, 33}) {
    file.write(someBytes(count));
    EXPECT_EQ(file.read(), someBytes(count));
  }
}

TEST(PipelineCacheFile, IgnoresOtherDrivers) {
  const TemporaryFolder folder;
  const ScopedVariable cache("RAYMAP_CACHE", folder.path().string());
  PipelineCacheFile(kIdentity).write(someBytes(100));
  DriverIdentity newer = kIdentity, other = kIdentity;
  newer.driverVersion = 8;
  other.cacheId[15] = 9;
  for (const DriverIdentity& identity : {newer, other}) {
    EXPECT_EQ(PipelineCacheFile(identity).name(), PipelineCacheFile(kIdentity).name());
    EXPECT_EQ(PipelineCacheFile(identity).read(), Bytes());
  }
  PipelineCacheFile(newer).write(someBytes(200));
  EXPECT_EQ(PipelineCacheFile(newer).read(), someBytes(200));
  EXPECT_EQ(PipelineCacheFile(kIdentity).read(), Bytes());
  DriverIdentity another = kIdentity;
  another.device = 0x2331;
  EXPECT_NE(PipelineCacheFile(another).name(), PipelineCacheFile(kIdentity).name());
}

TEST(PipelineCacheFile, IgnoresDamage) {
  const TemporaryFolder folder;
  const ScopedVariable cache("RAYMAP_CACHE", folder.path().string());
  const PipelineCacheFile file(kIdentity);
  file.write(someBytes(100));
  const fs::path path = folder.path() / file.name();
  const std::string whole = readBytes(path);
  const auto put = [&](const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; };
  for (size_t b = 0; b < whole.size(); ++b) {
    std::string damaged = whole;
    damaged[b] = char(damaged[b] ^ 0x40);
    put(damaged);
    ASSERT_EQ(file.read(), Bytes()) << "byte " << b;
    put(whole.substr(0, b));
    ASSERT_EQ(file.read(), Bytes()) << b << " bytes";
  }
  put(whole);
  EXPECT_EQ(file.read(), someBytes(100));
}

TEST(PipelineCacheFile, CanBeOff) {
  const TemporaryFolder folder;
  const PipelineCacheFile file(kIdentity);
  const ScopedVariable home("XDG_CACHE_HOME", folder.path().string());
  {
    const ScopedVariable cache("RAYMAP_CACHE", "off");
    file.write(someBytes(100));
    EXPECT_TRUE(fs::is_empty(folder.path()));
  }
  const ScopedVariable cache("RAYMAP_CACHE", std::nullopt);
  file.write(someBytes(100));
  EXPECT_EQ(file.read(), someBytes(100));
  const ScopedVariable off("RAYMAP_CACHE", "off");
  EXPECT_EQ(file.read(), Bytes());
}

class VulkanPipelines : public VulkanTest {};

TEST_F(VulkanPipelines, AreMadeOnceAndTogether) {
  static std::atomic<int> made;
  static PFN_vkCreateComputePipelines real;
  made = 0;
  const ReplacedEntry<PFN_vkCreateComputePipelines> counted(
      vkCreateComputePipelines,
      [](VkDevice owner, VkPipelineCache cache, uint32_t count, const VkComputePipelineCreateInfo* infos,
         const VkAllocationCallbacks* callbacks, VkPipeline* pipelines) {
        made += int(count);
        return real(owner, cache, count, infos, callbacks, pipelines);
      });
  real = counted.real();
  Pipelines pipelines(device(), {});
  const PipelineSource number{shaders::kNumberInvocations, {64, 0}},
      other{shaders::kNumberInvocations, {64, 1}}, full{shaders::kNumberInvocations, {64, 0}, true},
      wave{shaders::kWaveVertices, {64}};
  std::set<size_t> numbers;
  for (const PipelineSource& source : {number, other, full, wave}) numbers.insert(pipelines.add(source));
  EXPECT_EQ(numbers.size(), 4u);
  EXPECT_EQ(pipelines.add(number), pipelines.add(number));
  EXPECT_EQ(made, 0);
  std::set<VkPipeline> handles;
  for (const size_t n : numbers) handles.insert(pipelines.at(n));
  EXPECT_EQ(handles.size(), 4u);
  EXPECT_EQ(made, 4);
  const size_t late = pipelines.add({shaders::kNumberInvocations, {32, 0}});
  EXPECT_NE(pipelines.at(late), VK_NULL_HANDLE);
  EXPECT_EQ(made, 5);
}

TEST_F(VulkanPipelines, FailOnlyWhereTheyAreNeeded) {
  static PFN_vkCreateComputePipelines real;
  const ReplacedEntry<PFN_vkCreateComputePipelines> refusing(
      vkCreateComputePipelines,
      [](VkDevice owner, VkPipelineCache cache, uint32_t count, const VkComputePipelineCreateInfo* infos,
         const VkAllocationCallbacks* callbacks, VkPipeline* pipelines) {
        const auto* const constants = static_cast<const uint32_t*>(infos->stage.pSpecializationInfo->pData);
        if (constants[0] == 32) return VK_ERROR_UNKNOWN;
        return real(owner, cache, count, infos, callbacks, pipelines);
      });
  real = refusing.real();
  Pipelines pipelines(device(), {});
  const size_t good = pipelines.add({shaders::kNumberInvocations, {64, 0}}),
               bad = pipelines.add({shaders::kNumberInvocations, {32, 0}});
  EXPECT_NE(pipelines.at(good), VK_NULL_HANDLE);
  try {
    pipelines.at(bad);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("making the kernel number_invocations"), std::string::npos);
  }
}

/// Compiled code that the driver is given, and that it returns.
Bytes given, returned;
PFN_vkCreatePipelineCache realCreate = nullptr;

VKAPI_ATTR VkResult VKAPI_CALL createCache(VkDevice device, const VkPipelineCacheCreateInfo* info,
                                           const VkAllocationCallbacks* callbacks, VkPipelineCache* cache) {
  const auto* const bytes = static_cast<const std::byte*>(info->pInitialData);
  given.assign(bytes, bytes + info->initialDataSize);
  VkPipelineCacheCreateInfo empty = *info;
  empty.initialDataSize = 0;
  return realCreate(device, &empty, callbacks, cache);
}

VKAPI_ATTR VkResult VKAPI_CALL getCacheData(VkDevice, VkPipelineCache, size_t* size, void* data) {
  if (data) std::memcpy(data, returned.data(), returned.size());
  *size = returned.size();
  return VK_SUCCESS;
}

TEST_F(VulkanPipelines, StartFromTheLastRun) {
  const TemporaryFolder folder;
  const ScopedVariable cache("RAYMAP_CACHE", folder.path().string());
  const ReplacedEntry created(vkCreatePipelineCache, createCache);
  const ReplacedEntry stored(vkGetPipelineCacheData, getCacheData);
  realCreate = created.real();
  const auto run = [](bool usesKernel) {
    Device own({.validation = Validation::Off});
    const size_t number = own.pipelines().add({shaders::kNumberInvocations, {64, 0}});
    if (usesKernel) own.pipelines().at(number);
  };
  returned = someBytes(1000);
  run(false);  // Compiles nothing, so nothing is kept.
  EXPECT_TRUE(fs::is_empty(folder.path()));
  run(true);
  EXPECT_TRUE(given.empty());
  returned = someBytes(2000);
  run(true);
  EXPECT_EQ(given, someBytes(1000));
  run(false);
  EXPECT_EQ(given, someBytes(2000));
}

}  // namespace
}  // namespace raymap::vulkan
