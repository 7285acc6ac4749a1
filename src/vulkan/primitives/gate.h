#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/primitives/gate_push.h"

namespace raymap::vulkan {

/// Dispatches of known sizes that run only if a number on the device is not 0. The host need not know that
/// number.
class Gate {
 public:
  Gate(Device& device, const std::string& name);

  /// Reserves memory for this many dispatches. All previously recorded work must have completed.
  void reserve(uint32_t dispatches);
  /// Sets the number of groups of dispatch `index` for an open gate.
  void plan(uint32_t index, uint64_t groups);
  /// Opens or closes the gate for the dispatches recorded after it. `word` is the number's address.
  void record(Commands& commands, VkDeviceAddress word);
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, const Push& push, uint32_t index) const {
    commands.dispatchIndirect(kernel, push, actual_, sizeof(VkDispatchIndirectCommand) * index);
  }

 private:
  Kernel<GatePush> kernel_;
  DeviceBuffer planned_, actual_;
};

}  // namespace raymap::vulkan
