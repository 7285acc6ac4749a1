// Krayer & Müller 2019, §3.5, end: the winding number's threshold. Then distances in the mesh's units.

#include "vulkan/stages/finish.h"

#include <cmath>

#include "base/ceil_div.h"
#include "shaders/finish_spv.h"

namespace raymap::vulkan {

FinishStage::FinishStage(Device& device) : kernel_(device, shaders::kFinish, kGroup) {}

void FinishStage::record(Commands& commands, const Fields& fields, const glm::uvec3& dims,
                         const Options& options) {
  commands.dispatch(kernel_,
                    {.rays = {fields.rays[0], fields.rays[1], fields.rays[2]},
                     .winding = fields.winding,
                     .distance = fields.distance,
                     .confidence = fields.confidence,
                     .dims = dims,
                     .threshold = static_cast<float>(options.threshold),
                     .isInverted = options.isInverted ? 1U : 0U,
                     .band = options.band > 0.0 ? static_cast<float>(options.band) : INFINITY,
                     .scale = static_cast<float>(options.spacing)},
                    ceilDiv(uint64_t{dims.x} * dims.y * dims.z, kFinishedEach));
}

}  // namespace raymap::vulkan
