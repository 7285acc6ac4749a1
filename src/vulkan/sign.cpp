// Krayer & Müller 2019, §3.5, end: the winding number's threshold.

#include "sign.h"

#include <cmath>

#include "shaders/finish_spv.h"
#include "shaders/sign_spv.h"

namespace raymap::vulkan {

namespace {
constexpr uint32_t kGroup = 128;
}  // namespace

Sign::Sign(Device& device)
    : sign_(device, shaders::kSign, kGroup), finish_(device, shaders::kFinish, kGroup) {}

void Sign::record(Commands& commands, const Fields& fields, const glm::uvec3& dims, double threshold,
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
                    uint64_t{dims.x} * dims.y * dims.z);
}

void Sign::recordFinish(Commands& commands, VkDeviceAddress distance, uint32_t count, double band,
                        double scale) {
  commands.dispatch(finish_,
                    {.distance = distance,
                     .count = count,
                     .band = band > 0.0 ? static_cast<float>(band) : INFINITY,
                     .scale = static_cast<float>(scale)},
                    count);
}

}  // namespace raymap::vulkan
