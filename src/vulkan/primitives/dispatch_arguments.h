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
    uint32_t parts = 1;  ///< Number of entries to write, from `index` on.
    uint32_t mostGroups =
        UINT32_MAX;  ///< Groups of each of them but the last; above kMaxGroups a multiple of it.
  };

  DispatchArguments(Device& device, const std::string& name, uint32_t entries = 1);

  /// Reserves memory. All previously recorded work must have completed.
  void reserve(uint32_t entries) { entries_.resize<DispatchArgumentsEntry>(entries); }
  /// Records the write of one entry, or of its parts. Different entries may be written concurrently.
  void record(Commands& commands, uint32_t index, const Entry& entry);
  /// With `isMore` it may run at the same time as the command before.
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, const Push& push, uint32_t index,
                bool isMore = false) const {
    commands.dispatchIndirect(kernel, push, entries_, index * sizeof(DispatchArgumentsEntry), isMore);
  }
  /// Returns the address of an entry's number of groups times its scale.
  VkDeviceAddress scaledGroups(uint32_t index) const;

 private:
  Kernel<DispatchArgumentsPush> kernel_;
  DeviceBuffer entries_;
};

}  // namespace raymap::vulkan
