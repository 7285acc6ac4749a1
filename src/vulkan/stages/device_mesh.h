#pragma once

#include <cstdint>

#include "vulkan/device/api.h"

namespace raymap::vulkan {

/// A mesh in cell units on the device: three floats a vertex, three numbers of vertices a triangle.
struct DeviceMesh {
  VkDeviceAddress vertices = 0;
  VkDeviceAddress triangles = 0;
  uint32_t vertexCount = 0;
  uint32_t triangleCount = 0;
};

}  // namespace raymap::vulkan
