#include "vulkan/primitives/gate.h"

#include <algorithm>

#include "shaders/gate_spv.h"
#include "vulkan/primitives/dispatch_arguments_push.h"

namespace raymap::vulkan {

namespace {
constexpr uint32_t kGroup = 64;
}  // namespace

Gate::Gate(Device& device, const std::string& name)
    : kernel_(device, shaders::kGate, kGroup),
      planned_(device, "planned " + name, MemoryUse::Upload),
      actual_(device, name) {}

void Gate::reserve(uint32_t dispatches) {
  planned_.resize<VkDispatchIndirectCommand>(dispatches);
  actual_.resize<VkDispatchIndirectCommand>(dispatches);
}

void Gate::plan(uint32_t index, uint64_t groups) {
  const uint64_t y = std::max<uint64_t>((groups + kMaxGroups - 1) / kMaxGroups, 1);
  planned_.mapped<VkDispatchIndirectCommand>()[index] = {static_cast<uint32_t>((groups + y - 1) / y),
                                                         static_cast<uint32_t>(y), 1};
}

void Gate::record(Commands& commands, VkDeviceAddress word) {
  const auto count = static_cast<uint32_t>(actual_.bytes() / sizeof(uint32_t));
  commands.dispatch(
      kernel_, {.word = word, .planned = planned_.address(), .actual = actual_.address(), .count = count},
      count);
}

}  // namespace raymap::vulkan
