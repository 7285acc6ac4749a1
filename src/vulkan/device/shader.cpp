#include "vulkan/device/shader.h"

#include <string>

#include "base/hash.h"

namespace raymap::vulkan {

uint64_t hashOf(std::span<const Shader> shaders) {
  std::string all;
  for (const Shader& shader : shaders) {
    const std::string_view code(reinterpret_cast<const char*>(shader.code.data()), shader.code.size_bytes());
    all.append(shader.name).append(" ").append(std::to_string(raymap::hashOf(code))).append("\n");
  }
  return raymap::hashOf(all);
}

}  // namespace raymap::vulkan
