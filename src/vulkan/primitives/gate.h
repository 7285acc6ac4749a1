#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/primitives/gate_push.h"

namespace raymap::vulkan {

/// Dispatches of known sizes that run only if a number on the device is not 0; the host need not know it.
class Gate {
 public:
  Gate(Device& device, const std::string& name);

  /// Room for so many dispatches. Nothing recorded before may still have to run.
  void reserve(uint32_t dispatches);
  /// How many groups dispatch `index` has if the gate is open.
  void plan(uint32_t index, uint64_t groups);
  /// Opens or shuts the gate for what is recorded after it.
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
