#pragma once

#include <raymap/generate.h>

#include <array>

#include "vulkan/primitives/gate.h"
#include "vulkan/stages/winding_paths_push.h"
#include "vulkan/stages/winding_rays.h"

namespace raymap::vulkan {

/// The CPU's twin: curves that go elsewhere first. Both start from the six-ray average and replace it, where
/// any rays disagree.
class WindingPathsStage {
 public:
  explicit WindingPathsStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Makes room for grids of these dims. Nothing recorded before may still have to run.
  void reserve(const glm::ivec3& dims);
  /// §3.5, Eq. 9: `options.passes` offset points. For the grid of the last `reserve`.
  void recordAverage(Commands& commands, const WindingFields& fields, const Options& options);
  /// §3.5, Eq. 10-11: `options.passes` steps with four offset points each. Likewise.
  void recordEvolution(Commands& commands, const WindingFields& fields, const Options& options);

 private:
  /// Sets the points of passes `first` to `end`, and dispatches.
  void add(Commands& commands, WindingPathsPush push, const Options& options, int64_t first, int64_t end);
  WindingPathsPush push(const WindingFields& fields) const;

  glm::ivec3 dims_{0};
  Gate gate_;
  Kernel<WindingPathsPush> kernel_;
  DeviceBuffer next_;
};

}  // namespace raymap::vulkan
