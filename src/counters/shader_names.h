#pragma once

#include <cstring>
#include <string>

#include "shaders/raymap_vulkan_all.h"
#include "vulkan/device/api.h"
#include "vulkan/device/shader.h"

namespace raymap::vulkan {

/// Returns the stem of the library's shader that has this code.
inline std::string shaderName(const VkShaderModuleCreateInfo& info) {
  for (const Shader& shader : shaders::kAll)
    if (shader.code.size_bytes() == info.codeSize &&
        std::memcmp(shader.code.data(), info.pCode, info.codeSize) == 0)
      return std::string(shader.name);
  return "unknown shader";
}

}  // namespace raymap::vulkan
