#include "vulkan/device/guards.h"

#include <algorithm>

namespace raymap::vulkan {

namespace {
constexpr std::byte kPattern{0xA5};

bool isWhole(std::byte byte) {
  return byte == kPattern;
}
}  // namespace

void Guards::watch(VkBuffer buffer, const Guarded& guarded) {
  std::fill(guarded.memory, guarded.memory + kBytes, kPattern);
  std::fill(guarded.memory + kBytes + guarded.size, guarded.memory + guarded.capacity, kPattern);
  guarded_.insert_or_assign(buffer, guarded);
}

std::string Guards::damaged() const {
  std::string found;
  for (const auto& [buffer, guarded] : guarded_) {
    const std::byte* const memory = guarded.memory;
    const std::byte* const begin = memory + kBytes;
    const std::byte* const end = begin + guarded.size;
    const std::byte* const before = std::find_if_not(memory, begin, isWhole);
    const std::byte* const after = std::find_if_not(end, memory + guarded.capacity, isWhole);
    if (before != begin)
      found += guarded.name + ": written " + std::to_string(begin - before) + " bytes before it; ";
    if (after != memory + guarded.capacity)
      found += guarded.name + ": written " + std::to_string(after - end) + " bytes beyond its end; ";
  }
  return found;
}

}  // namespace raymap::vulkan
