#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/primitives/dispatch_arguments_push.h"

namespace raymap::vulkan {

/// Number of elements: `most`, or the number at `address` on the device, at most `most`.
struct Count {
  uint32_t most = 0;
  VkDeviceAddress address = 0;  ///< 0 if the host knows the number.
};

/// Arguments of dispatches over counts that only the device knows.
class DispatchArguments {
 public:
  /// Number of groups: ceil(count / itemsPerGroup), at least `fewestGroups`. The number of groups times
  /// `scale` is stored too, for further counts.
  struct Entry {
    Count count;
    uint32_t itemsPerGroup = 1;
    uint32_t fewestGroups = 0;
    uint32_t scale = 1;
  };

  DispatchArguments(Device& device, const std::string& name, uint32_t entries);

  /// Records the write of one entry. Different entries may be written concurrently.
  void record(Commands& commands, uint32_t index, const Entry& entry);
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, const Push& push, uint32_t index) const {
    commands.dispatchIndirect(kernel, push, entries_, index * sizeof(DispatchArgumentsEntry));
  }
  /// Returns the address of an entry's number of groups times its scale.
  VkDeviceAddress scaledGroups(uint32_t index) const;

 private:
  Kernel<DispatchArgumentsPush> kernel_;
  DeviceBuffer entries_;
};

}  // namespace raymap::vulkan
