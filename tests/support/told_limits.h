#pragma once

#include <functional>
#include <utility>

#include "counters/vulkan_entry.h"
#include "vulkan/device/device.h"

namespace raymap::vulkan {

/// Changes what the driver tells of a device, while it lives. One at a time.
class ToldLimits {
 public:
  using Change = std::function<void(VkPhysicalDeviceProperties2& properties)>;

  explicit ToldLimits(Change change) : replaced_(vkGetPhysicalDeviceProperties2, tell) {
    real_ = replaced_.real();
    change_ = std::move(change);
  }

  /// Returns the struct of this type among those that a query asks for, or null.
  template <class Struct>
  static Struct* find(VkPhysicalDeviceProperties2& properties, VkStructureType type) {
    for (auto* next = static_cast<VkBaseOutStructure*>(properties.pNext); next; next = next->pNext)
      if (next->sType == type) return reinterpret_cast<Struct*>(next);
    return nullptr;
  }

 private:
  static VKAPI_ATTR void VKAPI_CALL tell(VkPhysicalDevice device, VkPhysicalDeviceProperties2* properties) {
    real_(device, properties);
    change_(*properties);
  }

  static inline PFN_vkGetPhysicalDeviceProperties2 real_ = nullptr;
  static inline Change change_;
  ReplacedEntry<PFN_vkGetPhysicalDeviceProperties2> replaced_;
};

/// Returns a device that tells other limits.
inline Device deviceTelling(ToldLimits::Change change) {
  const ToldLimits told(std::move(change));
  return Device({.validation = Validation::Off});
}

}  // namespace raymap::vulkan
