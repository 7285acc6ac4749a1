#pragma once

#include "vulkan/device/api.h"

namespace raymap::vulkan {

/// Replaces an entry of Vulkan's function table during its lifetime. The product calls Vulkan through this
/// table, so programs can observe or change its calls, at no cost to others. Functions must be loaded before
/// (`sharedInstance`).
template <class Function>
class ReplacedEntry {
 public:
  ReplacedEntry(Function& entry, Function replacement) : entry_(&entry), real_(entry) { entry = replacement; }
  ~ReplacedEntry() { *entry_ = real_; }
  ReplacedEntry(const ReplacedEntry&) = delete;
  ReplacedEntry& operator=(const ReplacedEntry&) = delete;

  Function real() const { return real_; }

 private:
  Function* entry_;
  Function real_;
};

}  // namespace raymap::vulkan
