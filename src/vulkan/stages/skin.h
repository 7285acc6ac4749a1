#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/stages/skin_push.h"

namespace raymap::vulkan {

/// Moves vertices by joints, or all of them by one matrix.
class SkinStage {
 public:
  /// Addresses of three packed floats a rest vertex; four joints of 16 bits and four floats as their weights
  /// a vertex, or neither: then the first joint moves all; and three rows of four floats a joint. Those of
  /// `weights` and `matrices` are multiples of 16.
  struct Input {
    VkDeviceAddress rest = 0, joints = 0, weights = 0, matrices = 0;
    uint32_t vertexCount = 0;
    uint32_t jointCount = 0;
  };

  explicit SkinStage(Device& device);

  /// Writes three packed floats a vertex. One that follows a joint that does not exist is not finite.
  void record(Commands& commands, const Input& input, VkDeviceAddress vertices);

 private:
  Kernel<SkinPush> kernel_;
};

}  // namespace raymap::vulkan
