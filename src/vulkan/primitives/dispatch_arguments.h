#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/primitives/dispatch_arguments_push.h"

namespace raymap::vulkan {

/// Arguments of a dispatch over a number of items that only the device knows. Many groups become several
/// dispatches, whose groups `firstGroup` of the push constants numbers on.
class DispatchArguments {
 public:
  struct Work {
    uint32_t most = 0;  ///< Items, at most.
    uint32_t itemsPerGroup = 1;
    uint32_t mostGroups = kMostGroups;  ///< Groups of one dispatch, at most.
  };

  DispatchArguments(Device& device, const std::string& name);

  /// Reserves memory. All previously recorded work must have completed.
  void reserve(const Work& work);
  /// Reads the number of items, for the dispatches recorded after it.
  void record(Commands& commands, VkDeviceAddress count);
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, Push push) const {
    for (uint32_t part = 0; part < parts_; ++part) {
      if constexpr (requires { push.firstGroup; })
        push.firstGroup = part * work_.mostGroups;
      else if (parts_ > 1)
        throwUnnumbered();
      commands.dispatchIndirect(kernel, push, entries_, part * sizeof(VkDispatchIndirectCommand), part > 0);
    }
  }

 private:
  [[noreturn]] static void throwUnnumbered();

  Kernel<DispatchArgumentsPush> kernel_;
  Work work_;
  uint32_t parts_ = 0;
  DeviceBuffer entries_;
};

}  // namespace raymap::vulkan
