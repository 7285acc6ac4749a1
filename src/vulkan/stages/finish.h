#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/stages/finish_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/distance/finish.h: distances in the mesh's units.
class FinishStage {
 public:
  explicit FinishStage(Device& device);

  /// Clamps `count` distances in cell units to the band, if that is above zero, and multiplies them by
  /// `spacing`.
  void record(Commands& commands, VkDeviceAddress distance, uint32_t count, double band, double spacing);

 private:
  Kernel<FinishPush> kernel_;
};

}  // namespace raymap::vulkan
