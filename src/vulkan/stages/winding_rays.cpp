// Krayer & Müller 2019, §3.5: the average of the six rays, or one of them.

#include "vulkan/stages/winding_rays.h"

#include "base/ceil_div.h"
#include "method/cell_lattice.h"
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
  const WindingRaysPush push{.rays = {rays.axes[0], rays.axes[1], rays.axes[2]},
                             .winding = winding,
                             .doubtful = doubtful_.address(),
                             .dims = glm::uvec3(rays.dims),
                             .sampleCount = static_cast<uint32_t>(CellLattice{rays.dims}.count())};
  commands.fill(doubtful_, 0);
  const uint64_t samplesOfGroup = uint64_t{kWindingRaysGroup} * kWindingRaysRows;
  commands.dispatch(mode == SignMode::Ray ? oneRay_ : average_, push,
                    ceilDiv(push.sampleCount, samplesOfGroup) * kWindingRaysGroup);
}

}  // namespace raymap::vulkan
