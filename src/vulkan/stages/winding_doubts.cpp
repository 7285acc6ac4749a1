// Ours, after Krayer & Müller 2019, §3.5: where many faces end, the field cannot follow the crossings.

#include "vulkan/stages/winding_doubts.h"

#include <algorithm>

#include "base/ceil_div.h"
#include "method/cell_lattice.h"
#include "shaders/winding_doubts_spv.h"

namespace raymap::vulkan {

WindingDoubtsStage::WindingDoubtsStage(Device& device)
    : changes_(device, shaders::kWindingDoubts, std::max(kGroup, device.limits().maxSubgroupSize)),
      change_(device, "largest change of the winding number") {
  change_.resize<float>(1);
}

void WindingDoubtsStage::record(Commands& commands, const LatticeLines& rays, VkDeviceAddress winding,
                                VkDeviceAddress disagreeing) {
  commands.fill(change_, 0);
  commands.dispatch(changes_,
                    {.rays = {rays.axes[0], rays.axes[1], rays.axes[2]},
                     .winding = winding,
                     .change = change_.address(),
                     .disagreeing = disagreeing,
                     .dims = glm::uvec3(rays.dims)},
                    ceilDiv(CellLattice{rays.dims}.count(), kWindingDoubtsSamples));
}

}  // namespace raymap::vulkan
