#include "vulkan/primitives/dispatch_arguments.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "base/ceil_div.h"
#include "shaders/dispatch_arguments_spv.h"

namespace raymap::vulkan {

namespace {
// Few invocations work. With groups of one, GPU-assisted validation reports false errors, at least on
// lavapipe.
constexpr uint32_t kGroupSize = 32;
}  // namespace

DispatchArguments::DispatchArguments(Device& device, const std::string& name)
    : kernel_(device, shaders::kDispatchArguments, kGroupSize),
      planned_(device, "planned " + name, MemoryUse::Upload),
      entries_(device, name) {}

void DispatchArguments::reserve(const Work& work) {
  work_ = work;
  placeParts(std::array{ceilDiv(work.most, work.itemsPerGroup)});
}

void DispatchArguments::plan(std::span<const uint64_t> groups, uint32_t mostGroups) {
  work_ = {.mostGroups = mostGroups};
  placeParts(groups);
  planned_.resize<uint32_t>(firstParts_.back());
  uint32_t* planned = planned_.mapped<uint32_t>().data();
  for (size_t d = 0; d < groups.size(); ++d) {
    uint64_t left = groups[d];
    for (uint32_t part = firstParts_[d]; part < firstParts_[d + 1]; ++part, left -= *planned++)
      *planned = static_cast<uint32_t>(std::min<uint64_t>(left, work_.mostGroups));
  }
}

void DispatchArguments::placeParts(std::span<const uint64_t> groups) {
  // Dispatches of more groups extend along y. Their surplus groups would be groups of the next one.
  if (work_.mostGroups > kMaxGroups) work_.mostGroups -= work_.mostGroups % kMaxGroups;
  firstParts_.assign(1, 0);
  for (const uint64_t count : groups)
    firstParts_.push_back(firstParts_.back() + std::max(uint32_t(ceilDiv(count, work_.mostGroups)), 1U));
  entries_.resize<VkDispatchIndirectCommand>(firstParts_.back());
}

void DispatchArguments::record(Commands& commands, VkDeviceAddress number) {
  commands.dispatch(kernel_,
                    {.number = number,
                     .planned = planned_.address(),
                     .entries = entries_.address(),
                     .most = work_.most,
                     .itemsPerGroup = work_.itemsPerGroup,
                     .mostGroups = work_.mostGroups,
                     .parts = firstParts_.back()},
                    firstParts_.back());
}

void DispatchArguments::throwUnnumbered() {
  throw std::logic_error("a kernel whose groups are not numbered runs in several dispatches");
}

}  // namespace raymap::vulkan
