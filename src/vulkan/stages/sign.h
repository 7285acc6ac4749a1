#pragma once

#include <array>
#include <glm/glm.hpp>

#include "vulkan/device/commands.h"
#include "vulkan/stages/sign_push.h"

namespace raymap::vulkan {

/// The CPU's twin: signs and confidences.
class SignStage {
 public:
  struct Fields {
    std::array<VkDeviceAddress, 3> rays{};  ///< The ray map, by axis (shaders/ray_map.glsl).
    VkDeviceAddress winding = 0;
    VkDeviceAddress distance = 0;
    VkDeviceAddress confidence = 0;  ///< 0: not asked for.
  };

  explicit SignStage(Device& device);

  /// Negates the distance where |winding| > threshold, or everywhere else if inverted.
  void record(Commands& commands, const Fields& fields, const glm::uvec3& dims, double threshold,
              bool isInverted);

 private:
  Kernel<SignPush> sign_;
};

}  // namespace raymap::vulkan
