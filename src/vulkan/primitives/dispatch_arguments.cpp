#include "vulkan/primitives/dispatch_arguments.h"

#include <algorithm>
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
    : kernel_(device, shaders::kDispatchArguments, kGroupSize), entries_(device, name) {}

void DispatchArguments::reserve(const Work& work) {
  work_ = work;
  // Dispatches of more groups extend along y. Their surplus groups would be groups of the next one.
  if (work_.mostGroups > kMaxGroups) work_.mostGroups -= work_.mostGroups % kMaxGroups;
  parts_ = static_cast<uint32_t>(
      std::max(ceilDiv(ceilDiv(work.most, work.itemsPerGroup), work_.mostGroups), uint64_t{1}));
  entries_.resize<VkDispatchIndirectCommand>(parts_);
}

void DispatchArguments::record(Commands& commands, VkDeviceAddress count) {
  const DispatchArgumentsPush push{.count = count,
                                   .entries = entries_.address(),
                                   .most = work_.most,
                                   .itemsPerGroup = work_.itemsPerGroup,
                                   .mostGroups = work_.mostGroups,
                                   .parts = parts_};
  commands.dispatch(kernel_, push, parts_);
}

void DispatchArguments::throwUnnumbered() {
  throw std::logic_error("a kernel whose groups are not numbered runs in several dispatches");
}

}  // namespace raymap::vulkan
