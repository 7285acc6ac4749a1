// Krayer & Müller 2019, §3.5: the average of the six rays, or one of them.

#include "vulkan/stages/winding_rays.h"

#include "base/ceil_div.h"
#include "shaders/winding_rays_spv.h"

namespace raymap::vulkan {

WindingRaysStage::WindingRaysStage(Device& device)
    : average_(device, shaders::kWindingRays, kWindingRaysGroup, {0}),
      oneRay_(device, shaders::kWindingRays, kWindingRaysGroup, {1}),
      doubtful_(device, "doubtful samples") {
  doubtful_.resize<uint32_t>(1);
}

void WindingRaysStage::record(Commands& commands, const LatticeLines& rays, SignMode mode,
                              VkDeviceAddress winding) {
  WindingRaysPush push{.winding = winding, .doubtful = doubtful_.address(), .sampleCount = 1};
  for (int axis = 0; axis < 3; ++axis) {
    push.rays[axis] = rays.axes[static_cast<size_t>(axis)];
    push.dims[axis] = static_cast<uint32_t>(rays.dims[axis]);
    push.sampleCount *= push.dims[axis];
  }
  commands.fill(doubtful_, 0);
  const uint64_t samplesOfGroup = uint64_t{kWindingRaysGroup} * kWindingRaysRows;
  commands.dispatch(mode == SignMode::Ray ? oneRay_ : average_, push,
                    ceilDiv(push.sampleCount, samplesOfGroup) * kWindingRaysGroup);
}

}  // namespace raymap::vulkan
