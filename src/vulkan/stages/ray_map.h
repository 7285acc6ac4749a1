#pragma once

#include "vulkan/stages/crossings.h"
#include "vulkan/stages/ray_map_push.h"

namespace raymap::vulkan {

/// Computes r along the three axes (§3.5, Eq. 3-8). Edge e of a line then holds the signed crossings from
/// there to plus infinity. Thus r of sample i lies at i + 1, and that of the whole line at 0.
class RayMapStage {
 public:
  explicit RayMapStage(Device& device);

  /// Replaces the counts of all lattice edges by their sums.
  void record(Commands& commands, const LatticeLines& lines);

 private:
  void recordAxis(Commands& commands, const LatticeLines& lines, int axis, uint64_t done);

  uint32_t largestSubgroup_;
  Kernel<RayMapPush> across_;
  Kernel<RayMapPush> along_;
};

}  // namespace raymap::vulkan
