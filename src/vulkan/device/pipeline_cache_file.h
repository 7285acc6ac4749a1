#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace raymap::vulkan {

/// A device and its driver. Compiled kernels are valid for exactly these.
struct DriverIdentity {
  uint32_t vendor = 0;
  uint32_t device = 0;
  uint32_t driverVersion = 0;
  std::array<uint8_t, 16> cacheId{};  ///< VkPhysicalDeviceProperties::pipelineCacheUUID.

  bool operator==(const DriverIdentity&) const = default;
};

/// File in the user's cache folder (base/user_cache.h) with the kernels that a driver compiled. A new driver
/// version replaces the file of the last one.
class PipelineCacheFile {
 public:
  explicit PipelineCacheFile(const DriverIdentity& identity) : identity_(identity) {}

  /// Returns the name within the folder: "vulkan-pipelines-10de-2330.bin".
  std::filesystem::path name() const;
  /// Returns what was written for this driver. Returns nothing if there is no such file, it is damaged or
  /// another driver's, or the cache is off.
  std::vector<std::byte> read() const;
  /// Replaces the file. Does nothing if `compiled` holds no more than Vulkan's header, or on any failure.
  void write(std::span<const std::byte> compiled) const;

 private:
  DriverIdentity identity_;
};

}  // namespace raymap::vulkan
