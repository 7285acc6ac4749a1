#pragma once

#include <cstdint>

#include "vulkan/device/api.h"

namespace raymap::vulkan {

/// Mesh in cell units on the device: three floats per vertex, three vertex indices per triangle.
struct DeviceMesh {
  VkDeviceAddress vertices = 0;
  VkDeviceAddress triangles = 0;
  uint32_t vertexCount = 0;
  uint32_t triangleCount = 0;
};

}  // namespace raymap::vulkan
