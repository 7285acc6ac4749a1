#pragma once

#include <span>
#include <vector>

#include "vulkan/device/commands.h"
#include "vulkan/primitives/gate_push.h"

namespace raymap::vulkan {

/// Dispatches of known sizes that run only if a number on the device is not 0. The host need not know that
/// number. Large ones become several, whose groups `firstGroup` of the push constants numbers on.
class Gate {
 public:
  Gate(Device& device, const std::string& name);

  /// Sets the number of groups of each dispatch for an open gate. A dispatch of more than `most` becomes
  /// several, if `most` is no more than kMaxGroups. All previously recorded work must have completed.
  void plan(std::span<const uint64_t> groups, uint32_t most = UINT32_MAX);
  /// Opens or closes the gate for the dispatches recorded after it. `word` is the number's address.
  void record(Commands& commands, VkDeviceAddress word);
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, Push push, uint32_t index) const {
    for (uint32_t part = firstParts_[index]; part < firstParts_[index + 1]; ++part) {
      if constexpr (requires { push.firstGroup; }) push.firstGroup = (part - firstParts_[index]) * most_;
      commands.dispatchIndirect(kernel, push, actual_, sizeof(VkDispatchIndirectCommand) * part,
                                part > firstParts_[index]);
    }
  }

 private:
  Kernel<GatePush> kernel_;
  uint32_t most_ = UINT32_MAX;
  std::vector<uint32_t> firstParts_;  // First part of each dispatch, and the number of all.
  DeviceBuffer planned_, actual_;
};

}  // namespace raymap::vulkan
