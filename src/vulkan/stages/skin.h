#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/stages/skin_push.h"

namespace raymap::vulkan {

/// Moves vertices by joints, or all of them by one matrix.
class SkinStage {
 public:
  /// Addresses of the input. `rest` has three packed floats per vertex. `joints` has four 16-bit numbers per
  /// vertex, and `weights` four floats; without both, the first joint moves all vertices. `matrices` has
  /// three rows of four floats per joint. The addresses of `weights` and `matrices` are multiples of 16.
  struct Input {
    VkDeviceAddress rest = 0, joints = 0, weights = 0, matrices = 0;
    uint32_t vertexCount = 0;
    uint32_t jointCount = 0;
  };

  explicit SkinStage(Device& device);

  /// Writes three packed floats per vertex. A vertex that follows a nonexistent joint is not finite.
  void record(Commands& commands, const Input& input, VkDeviceAddress vertices);

 private:
  Kernel<SkinPush> kernel_;
};

}  // namespace raymap::vulkan
