// Krayer & Müller 2019, §3.3, last paragraph.

#include "vulkan/stages/raster_distance.h"

#include "shaders/raster_distance_spv.h"

namespace raymap::vulkan {

RasterDistanceStage::RasterDistanceStage(Device& device)
    : kernel_(device, shaders::kRasterDistance, 256), levels_(device) {}

void RasterDistanceStage::reserve(const glm::ivec3& dims, std::span<const CellLevelData> levels) {
  dims_ = dims;
  kernel_.choose(levels.size() == 1);
  levels_.reserve(levels);
}

void RasterDistanceStage::record(Commands& commands, VkDeviceAddress distance) {
  levels_.record(commands);
  commands.dispatch(
      *kernel_,
      {.levels = levels_.address(), .distance = distance, .dims = dims_, .levelCount = levels_.count()},
      uint64_t{dims_.x} * dims_.y * dims_.z);
}

}  // namespace raymap::vulkan
