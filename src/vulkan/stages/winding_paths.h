#pragma once

#include <raymap/options.h>

#include <array>

#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan/stages/winding_paths_push.h"
#include "vulkan/stages/winding_rays.h"

namespace raymap::vulkan {

/// GPU twin of cpu/sign/winding_paths.h: curves by way of other points. Both functions start from the six-ray
/// average and replace it if any rays disagree.
class WindingPathsStage {
 public:
  explicit WindingPathsStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for grids of these dims. All previously recorded work must have completed.
  void reserve(const glm::ivec3& dims);
  /// Averages over `options.passes` passes (§3.5, Eq. 9), on the grid of the last `reserve`.
  void recordAverage(Commands& commands, const WindingFields& fields, const FieldOptions& options);
  /// Takes `options.passes` steps (§3.5, Eq. 10-11), on the grid of the last `reserve`.
  void recordEvolution(Commands& commands, const WindingFields& fields, const FieldOptions& options);

 private:
  /// Adds the curves through the points [first, end) and divides the sums by the push constants' divisor.
  void add(Commands& commands, WindingPathsPush push, const FieldOptions& options, int64_t first,
           int64_t end);
  /// Copies the numbers at `from` to `fields.winding`.
  void copy(Commands& commands, VkDeviceAddress from, const WindingFields& fields);
  WindingPathsPush push(const WindingFields& fields) const;

  glm::ivec3 dims_{0};
  DispatchArguments gate_;
  Kernel<WindingPathsPush> zeroOutside_, raysOutside_;  // By the value of points outside the grid.
  DeviceBuffer next_;
};

}  // namespace raymap::vulkan
