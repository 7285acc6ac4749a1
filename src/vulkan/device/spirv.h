#pragma once

#include <cstdint>
#include <span>

namespace raymap::vulkan {

/// Returns the number of bytes of push constants that a module declares; 0 if none.
uint32_t pushConstantBytes(std::span<const uint32_t> code);

}  // namespace raymap::vulkan
