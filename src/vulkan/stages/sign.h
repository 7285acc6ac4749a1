#pragma once

#include <array>
#include <glm/glm.hpp>

#include "vulkan/device/commands.h"
#include "vulkan/stages/sign_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/sign/sign.h: signs and confidences.
class SignStage {
 public:
  struct Fields {
    std::array<VkDeviceAddress, 3> rays{};  ///< The ray map, by axis (vulkan/stages/ray_map.glsl).
    VkDeviceAddress winding = 0;
    VkDeviceAddress distance = 0;
    VkDeviceAddress confidence = 0;  ///< 0: not requested.
  };

  explicit SignStage(Device& device);

  /// Negates the distance where |winding| > threshold; if inverted, negates it everywhere else.
  void record(Commands& commands, const Fields& fields, const glm::uvec3& dims, double threshold,
              bool isInverted);

 private:
  Kernel<SignPush> sign_;
};

}  // namespace raymap::vulkan
