#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace raymap::vulkan {

/// Embedded SPIR-V, named by its file's stem.
struct Shader {
  std::string_view name;
  std::span<const uint32_t> code;
};

}  // namespace raymap::vulkan
