#pragma once

#include <span>
#include <vector>

#include "vulkan/device/commands.h"
#include "vulkan/primitives/dispatch_arguments_push.h"

namespace raymap::vulkan {

/// Arguments of dispatches that depend on a number that only the device knows. Many groups become several
/// dispatches, whose groups `firstGroup` of the push constants numbers on.
class DispatchArguments {
 public:
  struct Work {
    uint32_t most = 0;  ///< Items, at most.
    uint32_t itemsPerGroup = 1;
    uint32_t mostGroups = kMostGroups;  ///< Groups of one dispatch, at most.
  };

  DispatchArguments(Device& device, const std::string& name);

  /// Reserves memory for one dispatch over that number of items. All previously recorded work must have
  /// completed.
  void reserve(const Work& work);
  /// Plans dispatches of so many groups each, all of which run unless the number is 0. All previously
  /// recorded work must have completed.
  void plan(std::span<const uint64_t> groups, uint32_t mostGroups = UINT32_MAX);
  /// Reads the number at an address, for the dispatches recorded after it.
  void record(Commands& commands, VkDeviceAddress number);
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, Push push, uint32_t index = 0) const {
    const uint32_t first = firstParts_[index];
    for (uint32_t part = first; part < firstParts_[index + 1]; ++part) {
      if constexpr (requires { push.firstGroup; })
        push.firstGroup = (part - first) * work_.mostGroups;
      else if (part > first)
        throwUnnumbered();
      commands.dispatchIndirect(kernel, push, entries_, part * sizeof(VkDispatchIndirectCommand),
                                part > first);
    }
  }

 private:
  void placeParts(std::span<const uint64_t> groups);
  [[noreturn]] static void throwUnnumbered();

  Kernel<DispatchArgumentsPush> kernel_;
  Work work_;
  std::vector<uint32_t> firstParts_;  // First part of each dispatch, and the number of all.
  DeviceBuffer planned_, entries_;
};

}  // namespace raymap::vulkan
