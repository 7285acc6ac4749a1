#pragma once

#include <array>

#include "cpu/sign/ray_map.h"
#include "vulkan_device.h"

namespace raymap::vulkan {

/// Returns r along an axis, as the device holds it (vulkan/stages/ray_map.glsl).
inline std::vector<int32_t> suffixSums(const cpu::RayMap& map, int axis) {
  glm::ivec3 dims = map.dims;
  ++dims[axis];
  std::vector<int32_t> sums;
  for (glm::ivec3 s(0); s.z < dims.z; ++s.z)
    for (s.y = 0; s.y < dims.y; ++s.y)
      for (s.x = 0; s.x < dims.x; ++s.x) {
        glm::ivec3 before = s;
        --before[axis];
        sums.push_back(map.ray(axis, before));
      }
  return sums;
}

/// A test of a stage that reads the ray map: it uploads the CPU's.
class VulkanRaysTest : public VulkanTest {
 protected:
  class Rays {
   public:
    explicit Rays(const cpu::RayMap& map) {
      for (int axis = 0; axis < 3; ++axis) sums_[size_t(axis)] = upload(suffixSums(map, axis), "rays");
    }
    std::array<VkDeviceAddress, 3> addresses() const {
      return {sums_[0].address(), sums_[1].address(), sums_[2].address()};
    }

   private:
    std::array<DeviceBuffer, 3> sums_;
  };
};

}  // namespace raymap::vulkan
