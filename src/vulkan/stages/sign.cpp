// Krayer & Müller 2019, §3.5, end: the winding number's threshold.

#include "vulkan/stages/sign.h"

#include "base/ceil_div.h"
#include "shaders/sign_spv.h"

namespace raymap::vulkan {

SignStage::SignStage(Device& device) : sign_(device, shaders::kSign, kGroup) {}

void SignStage::record(Commands& commands, const Fields& fields, const glm::uvec3& dims, double threshold,
                       bool isInverted) {
  commands.dispatch(sign_,
                    {.rays = {fields.rays[0], fields.rays[1], fields.rays[2]},
                     .winding = fields.winding,
                     .distance = fields.distance,
                     .confidence = fields.confidence,
                     .gridX = dims.x,
                     .gridY = dims.y,
                     .gridZ = dims.z,
                     .threshold = static_cast<float>(threshold),
                     .isInverted = isInverted ? 1U : 0U},
                    ceilDiv(uint64_t{dims.x} * dims.y * dims.z, kSignedEach));
}

}  // namespace raymap::vulkan
