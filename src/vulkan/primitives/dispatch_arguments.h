#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/primitives/dispatch_arguments_push.h"

namespace raymap::vulkan {

/// How many elements there are: `most`, or what the device finds at `address`, which is never more.
struct Count {
  uint32_t most = 0;
  VkDeviceAddress address = 0;  ///< 0: the host knows it.
};

/// Arguments of dispatches over counts that only the device knows.
class DispatchArguments {
 public:
  /// What an entry says: ceil(count / itemsPerGroup) groups, but at least `fewestGroups`, and the number of
  /// groups times `scale` beside it, for further counts.
  struct Entry {
    Count count;
    uint32_t itemsPerGroup = 1;
    uint32_t fewestGroups = 0;
    uint32_t scale = 1;
  };

  DispatchArguments(Device& device, const std::string& name, uint32_t entries);

  /// Records the writing of one entry. Different entries may be written concurrently.
  void record(Commands& commands, uint32_t index, const Entry& entry);
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, const Push& push, uint32_t index) const {
    commands.dispatchIndirect(kernel, push, entries_, index * sizeof(DispatchArgumentsEntry));
  }
  /// Where an entry's number of groups times its scale lies.
  VkDeviceAddress scaledGroups(uint32_t index) const;

 private:
  Kernel<DispatchArgumentsPush> kernel_;
  DeviceBuffer entries_;
};

}  // namespace raymap::vulkan
