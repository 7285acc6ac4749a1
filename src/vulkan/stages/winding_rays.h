#pragma once

#include <raymap/options.h>

#include "vulkan/stages/crossings.h"
#include "vulkan/stages/winding_rays_push.h"

namespace raymap::vulkan {

/// Input and output of the stages that improve on the six rays.
struct WindingFields {
  std::array<VkDeviceAddress, 3> rays{};  ///< The ray map, by axis (vulkan/stages/ray_map.glsl).
  VkDeviceAddress winding = 0;            ///< One value per sample; unchanged if all rays agree.
  VkDeviceAddress doubtful = 0;           ///< Number of samples whose rays disagree.
};

/// Averages the six rays of each sample, or takes one.
class WindingRaysStage {
 public:
  explicit WindingRaysStage(Device& device);

  /// Writes a float per sample to `winding`, from a ray map. `SignMode::Ray` takes the ray along +x, any
  /// other mode the average.
  void record(Commands& commands, const LatticeLines& rays, SignMode mode, VkDeviceAddress winding);
  /// Number of samples whose rays disagree, one 32-bit number. If it is 0, the average is the solution of
  /// every mode.
  const DeviceBuffer& doubtful() const { return doubtful_; }

 private:
  Kernel<WindingRaysPush> average_, oneRay_;
  DeviceBuffer doubtful_;
};

}  // namespace raymap::vulkan
