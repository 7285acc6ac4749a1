#pragma once

#include <array>
#include <glm/glm.hpp>

#include "commands.h"
#include "shared/sign.h"

namespace raymap::vulkan {

/// The CPU's twin: signs, confidences, and distances in the mesh's units.
class Sign {
 public:
  struct Fields {
    std::array<VkDeviceAddress, 3> rays{};  ///< The ray map, by axis (shaders/ray_map.glsl).
    VkDeviceAddress winding = 0;
    VkDeviceAddress distance = 0;
    VkDeviceAddress confidence = 0;  ///< 0: not asked for.
  };

  explicit Sign(Device& device);

  /// Negates the distance where |winding| > threshold, or everywhere else if inverted.
  void record(Commands& commands, const Fields& fields, const glm::uvec3& dims, double threshold,
              bool isInverted);
  /// Clamps distances to a band of so many cells, if it is above zero, and scales them.
  void recordFinish(Commands& commands, VkDeviceAddress distance, uint32_t count, double band, double scale);

 private:
  Kernel<SignPush> sign_;
  Kernel<FinishPush> finish_;
};

}  // namespace raymap::vulkan
