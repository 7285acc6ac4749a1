#pragma once

#include "vulkan/stages/crossings.h"
#include "vulkan/stages/winding_doubts_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/sign/winding_doubts.h: finds what the doubt in winding numbers depends on.
class WindingDoubtsStage {
 public:
  explicit WindingDoubtsStage(Device& device);

  /// If the number at `disagreeing` is 0, no number is doubted, and the change is 0.
  void record(Commands& commands, const LatticeLines& rays, VkDeviceAddress winding,
              VkDeviceAddress disagreeing);
  /// Returns the largest change along a crossed edge, a float.
  const DeviceBuffer& change() const { return change_; }

 private:
  Kernel<WindingDoubtsPush> changes_;
  DeviceBuffer change_;
};

}  // namespace raymap::vulkan
