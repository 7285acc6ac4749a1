#include "vulkan/primitives/gate.h"

#include <algorithm>
#include <stdexcept>

#include "base/ceil_div.h"
#include "shaders/gate_spv.h"
#include "vulkan/device/dispatch_limits.h"

namespace raymap::vulkan {

namespace {
constexpr uint32_t kGateGroup = 64;

VkDispatchIndirectCommand argumentsOf(uint64_t groups) {
  const uint64_t y = std::max<uint64_t>(ceilDiv(groups, kMaxGroups), 1);
  return {static_cast<uint32_t>(ceilDiv(groups, y)), static_cast<uint32_t>(y), 1};
}
}  // namespace

Gate::Gate(Device& device, const std::string& name)
    : kernel_(device, shaders::kGate, kGateGroup),
      planned_(device, "planned " + name, MemoryUse::Upload),
      actual_(device, name) {}

void Gate::plan(std::span<const uint64_t> groups, uint32_t most) {
  most_ = most;
  firstParts_.assign(1, 0);
  for (const uint64_t count : groups)
    firstParts_.push_back(firstParts_.back() +
                          static_cast<uint32_t>(std::max<uint64_t>(ceilDiv(count, most), 1)));
  if (firstParts_.back() > groups.size() && most > kMaxGroups)
    throw std::logic_error("surplus groups of a part would be groups of the next one");
  planned_.resize<VkDispatchIndirectCommand>(firstParts_.back());
  actual_.resize<VkDispatchIndirectCommand>(firstParts_.back());
  const std::span<VkDispatchIndirectCommand> planned = planned_.mapped<VkDispatchIndirectCommand>();
  for (size_t d = 0; d < groups.size(); ++d) {
    uint64_t left = groups[d];
    for (uint32_t part = firstParts_[d]; part < firstParts_[d + 1];
         ++part, left -= std::min<uint64_t>(left, most))
      planned[part] = argumentsOf(std::min<uint64_t>(left, most));
  }
}

void Gate::record(Commands& commands, VkDeviceAddress word) {
  const auto count = static_cast<uint32_t>(actual_.bytes() / sizeof(uint32_t));
  commands.dispatch(
      kernel_, {.word = word, .planned = planned_.address(), .actual = actual_.address(), .count = count},
      count);
}

}  // namespace raymap::vulkan
