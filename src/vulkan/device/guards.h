#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "vulkan/device/api.h"

namespace raymap::vulkan {

/// For tests: every buffer lies between bytes that nobody may write, so that stray writes are found.
class Guards {
 public:
  /// Bytes before and, at least, after each buffer's own. Keeps addresses aligned.
  static constexpr VkDeviceSize kBytes = 256;

  struct Guarded {
    std::string name;
    std::byte* memory;      ///< All of it, mapped.
    VkDeviceSize size;      ///< The buffer's own bytes, from `kBytes` on.
    VkDeviceSize capacity;  ///< Of all of it.
  };

  /// Fills the guards of a buffer and watches them from now on. The device must be idle.
  void watch(VkBuffer buffer, const Guarded& guarded);
  void forget(VkBuffer buffer) { guarded_.erase(buffer); }
  /// Names the buffers with damaged guards, and where; empty if all are whole. The device must be idle.
  std::string damaged() const;

 private:
  std::map<VkBuffer, Guarded> guarded_;
};

}  // namespace raymap::vulkan
