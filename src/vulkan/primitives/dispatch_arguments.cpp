#include "vulkan/primitives/dispatch_arguments.h"

#include <cstddef>

#include "shaders/dispatch_arguments_spv.h"

namespace raymap::vulkan {

namespace {
// One invocation works. With groups of one, GPU-assisted validation reports false errors, at least on
// lavapipe.
constexpr uint32_t kGroupSize = 32;
}  // namespace

DispatchArguments::DispatchArguments(Device& device, const std::string& name, uint32_t entries)
    : kernel_(device, shaders::kDispatchArguments, kGroupSize), entries_(device, name) {
  entries_.resize<DispatchArgumentsEntry>(entries);
}

void DispatchArguments::record(Commands& commands, uint32_t index, const Entry& entry) {
  const DispatchArgumentsPush push{.count = entry.count.address,
                                   .entry = entries_.address() + index * sizeof(DispatchArgumentsEntry),
                                   .most = entry.count.most,
                                   .itemsPerGroup = entry.itemsPerGroup,
                                   .fewestGroups = entry.fewestGroups,
                                   .scale = entry.scale};
  commands.dispatch(kernel_, push, 1);
}

VkDeviceAddress DispatchArguments::scaledGroups(uint32_t index) const {
  return entries_.address() + index * sizeof(DispatchArgumentsEntry) +
         offsetof(DispatchArgumentsEntry, scaledGroups);
}

}  // namespace raymap::vulkan
