// Last stage: distances in the mesh's units.

#include "vulkan/stages/finish.h"

#include <cmath>

#include "base/ceil_div.h"
#include "shaders/finish_spv.h"

namespace raymap::vulkan {

FinishStage::FinishStage(Device& device) : kernel_(device, shaders::kFinish, 128) {}

void FinishStage::record(Commands& commands, VkDeviceAddress distance, uint32_t count, double band,
                         double spacing) {
  commands.dispatch(kernel_,
                    {.distance = distance,
                     .count = count,
                     .band = band > 0.0 ? static_cast<float>(band) : INFINITY,
                     .scale = static_cast<float>(spacing)},
                    ceilDiv(count, kFinishedEach));
}

}  // namespace raymap::vulkan
