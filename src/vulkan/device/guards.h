#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "vulkan/device/api.h"

namespace raymap::vulkan {

/// Guard bytes around every buffer, for tests: they reveal stray writes.
class Guards {
 public:
  /// Bytes before each buffer, and at least as many after it. Keeps addresses aligned.
  static constexpr VkDeviceSize kBytes = 256;

  struct Guarded {
    std::string name;
    std::byte* memory;      ///< Whole buffer with its guards, mapped.
    VkDeviceSize size;      ///< Size of the buffer's own bytes, which start at `kBytes`.
    VkDeviceSize capacity;  ///< Size of the whole buffer with its guards.
  };

  /// Fills a buffer's guards and watches them from now on. The device must be idle.
  void watch(VkBuffer buffer, const Guarded& guarded);
  /// Returns the name of a buffer that is watched.
  const std::string& nameOf(VkBuffer buffer) const { return guarded_.at(buffer).name; }
  void forget(VkBuffer buffer) { guarded_.erase(buffer); }
  /// Names the buffers with damaged guards and the places of the damage; empty if all are intact. The device
  /// must be idle.
  std::string damaged() const;

 private:
  std::map<VkBuffer, Guarded> guarded_;
};

}  // namespace raymap::vulkan
