#include "vulkan/device/buffer.h"

#include <raymap/error.h>

#include <string>
#include <utility>
#include <vector>

#include "shaders/number_invocations.h"
#include "shaders/number_invocations_spv.h"
#include "told_limits.h"
#include "vulkan/device/scratch_memory.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanBuffer : public VulkanTest {};

TEST_F(VulkanBuffer, KeepsABuffersMemory) {
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

TEST_F(VulkanBuffer, KeepsToTheLimit) {
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

TEST_F(VulkanBuffer, MapsWhatTheHostShares) {
  Device plain({.guards = false});
  DeviceBuffer own(plain, "own"), upload(plain, "upload", MemoryUse::Upload);
  own.resize<uint32_t>(10);
  upload.resize<uint32_t>(10);
  EXPECT_EQ(upload.mapped<uint32_t>().size(), 10u);
  const bool isSoftware = plain.info().type == DeviceType::Software;
  EXPECT_EQ(own.mapped<uint32_t>().empty(), own.mapped<uint32_t>().data() == nullptr);
  EXPECT_TRUE(!isSoftware || own.mapped<uint32_t>().size() == 10);
}

TEST_F(VulkanBuffer, RefusesMoreMemoryThanThereIs) {
  DeviceBuffer buffer(device(), "monster");
  for (const uint64_t bytes : {uint64_t{1} << 60, device().availableMemory(0) + (1U << 20)}) {
    try {
      buffer.resize<uint8_t>(bytes);
      ADD_FAILURE() << "got " << bytes << " bytes";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(),
                bytes > device().limits().bufferSize ? ErrorCode::Memory : ErrorCode::DeviceMemory);
      EXPECT_NE(std::string(error.what()).find("monster"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(buffer.address(), 0u);
  buffer.resize<uint8_t>(100);  // The buffer is still usable.
  EXPECT_NE(buffer.address(), 0u);
}

/// Returns a device that tells these limits.
Device deviceWithBuffers(VkDeviceSize bufferSize, VkDeviceSize allocationSize) {
  return deviceTelling([=](VkPhysicalDeviceProperties2& properties) {
    if (auto* v11 = ToldLimits::find<VkPhysicalDeviceVulkan11Properties>(
            properties, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES))
      v11->maxMemoryAllocationSize = allocationSize;
    if (auto* v13 = ToldLimits::find<VkPhysicalDeviceVulkan13Properties>(
            properties, VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES))
      v13->maxBufferSize = bufferSize;
  });
}

TEST_F(VulkanBuffer, KeepsBuffersBelowEveryLimit) {
  constexpr VkDeviceSize kMebi = 1 << 20, kHuge = VkDeviceSize{1} << 40;
  for (const auto& [bufferSize, allocationSize] : {std::pair(kMebi, kHuge), std::pair(kHuge, kMebi)}) {
    Device small = deviceWithBuffers(bufferSize, allocationSize);
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
  EXPECT_EQ(deviceWithBuffers(kHuge, kHuge).limits().bufferSize, VkDeviceSize{1} << 33);
}

TEST_F(VulkanBuffer, SharesScratchMemory) {
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

TEST_F(VulkanBuffer, FindsStrayWrites) {
  DeviceBuffer buffer = upload(std::vector<uint32_t>(1000), "watched");
  buffer.resize<uint32_t>(990);
  EXPECT_EQ(device().guards()->damaged(), "");
  Kernel<NumberInvocationsPush> kernel(device(), shaders::kNumberInvocations, 64);
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

}  // namespace
}  // namespace raymap::vulkan
