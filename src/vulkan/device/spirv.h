#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace raymap::vulkan {

inline constexpr size_t kSpirvHeaderWords = 5;

/// Returns the opcode of an instruction.
inline uint32_t opOf(std::span<const uint32_t> instruction) {
  return instruction[0] & 0xFFFFU;
}

/// Calls `visit` with the words of each instruction of a module, from its first word on.
template <class Visit>
void forEachInstruction(std::span<const uint32_t> code, Visit&& visit) {
  for (size_t at = kSpirvHeaderWords; at < code.size(); at += code[at] >> 16)
    visit(code.subspan(at, code[at] >> 16));
}

/// Returns the number of bytes of push constants that a module declares; 0 if none.
uint32_t pushConstantBytes(std::span<const uint32_t> code);

}  // namespace raymap::vulkan
