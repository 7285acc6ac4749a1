#pragma once

#include "crossings.h"
#include "shared/winding_rays.h"

namespace raymap::vulkan {

/// The average of the six rays of each sample.
class WindingRays {
 public:
  explicit WindingRays(Device& device);

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
