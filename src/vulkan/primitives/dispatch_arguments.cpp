#include "vulkan/primitives/dispatch_arguments.h"

#include <cstddef>
#include <stdexcept>

#include "shaders/dispatch_arguments_spv.h"

namespace raymap::vulkan {

namespace {
// Few invocations work. With groups of one, GPU-assisted validation reports false errors, at least on
// lavapipe.
constexpr uint32_t kGroupSize = 32;
}  // namespace

DispatchArguments::DispatchArguments(Device& device, const std::string& name, uint32_t entries)
    : kernel_(device, shaders::kDispatchArguments, kGroupSize), entries_(device, name) {
  reserve(entries);
}

void DispatchArguments::record(Commands& commands, uint32_t index, const Entry& entry) {
  if (entry.parts > 1 && entry.mostGroups > kMaxGroups && entry.mostGroups % kMaxGroups != 0)
    throw std::logic_error("surplus groups of a part would be groups of the next one");
  const DispatchArgumentsPush push{.count = entry.count.address,
                                   .entry = entries_.address() + index * sizeof(DispatchArgumentsEntry),
                                   .most = entry.count.most,
                                   .itemsPerGroup = entry.itemsPerGroup,
                                   .fewestGroups = entry.fewestGroups,
                                   .scale = entry.scale,
                                   .parts = entry.parts,
                                   .mostGroups = entry.mostGroups};
  commands.dispatch(kernel_, push, entry.parts);
}

VkDeviceAddress DispatchArguments::scaledGroups(uint32_t index) const {
  return entries_.address() + index * sizeof(DispatchArgumentsEntry) +
         offsetof(DispatchArgumentsEntry, scaledGroups);
}

}  // namespace raymap::vulkan
