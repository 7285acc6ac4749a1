#pragma once

#include <array>
#include <glm/glm.hpp>

#include "vulkan/device/commands.h"
#include "vulkan/stages/finish_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/sign/sign.h and cpu/distance/finish.h, which one kernel joins: signs and confidences, then
/// distances in the mesh's units.
class FinishStage {
 public:
  struct Fields {
    std::array<VkDeviceAddress, 3> rays{};  ///< The ray map, by axis (vulkan/stages/ray_map.glsl).
    VkDeviceAddress winding = 0;            ///< 0: distances stay unsigned.
    VkDeviceAddress distance = 0;
    VkDeviceAddress confidence = 0;  ///< 0: not requested.
  };
  struct Options {
    double threshold = 0.5;
    bool isInverted = false;
    double band = 0.0;  ///< In cells; 0: none.
    double spacing = 1.0;
  };

  explicit FinishStage(Device& device);

  /// Negates the distance where |winding| > threshold; if inverted, negates it everywhere else. Clamps it to
  /// the band, and multiplies it by the spacing.
  void record(Commands& commands, const Fields& fields, const glm::uvec3& dims, const Options& options);

 private:
  Kernel<FinishPush> kernel_;
};

}  // namespace raymap::vulkan
