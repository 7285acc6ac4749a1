#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace raymap::vulkan {

/// Embedded SPIR-V and the stem of its file's name.
struct Shader {
  std::string_view name;
  std::span<const uint32_t> code;
};

/// Returns a hash of the shaders' names and code, in their order.
uint64_t hashOf(std::span<const Shader> shaders);

}  // namespace raymap::vulkan
