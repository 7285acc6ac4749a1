#pragma once

#include "vulkan/stages/crossings.h"
#include "vulkan/stages/winding_rays_push.h"

namespace raymap::vulkan {

/// What stages that know better than the six rays read and write.
struct WindingFields {
  std::array<VkDeviceAddress, 3> rays{};  ///< The ray map, by axis (shaders/ray_map.glsl).
  VkDeviceAddress winding = 0;            ///< Of every sample; left alone where all rays agree.
  VkDeviceAddress doubtful = 0;           ///< Number of samples whose rays disagree.
};

/// The average of the six rays of each sample.
class WindingRaysStage {
 public:
  explicit WindingRaysStage(Device& device);

  /// Writes a float for each sample to `winding`, from a ray map.
  void record(Commands& commands, const LatticeLines& rays, VkDeviceAddress winding);
  /// How many samples' rays disagree, one 32-bit number: where none do, the average is the solution of every
  /// mode.
  const DeviceBuffer& doubtful() const { return doubtful_; }

 private:
  Kernel<WindingRaysPush> kernel_;
  DeviceBuffer doubtful_;
};

}  // namespace raymap::vulkan
