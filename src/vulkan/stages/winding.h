#pragma once

#include "vulkan/stages/winding_harmonic.h"
#include "vulkan/stages/winding_paths.h"
#include "vulkan/stages/winding_rays.h"

namespace raymap::vulkan {

/// GPU twin of cpu/sign/winding.h: the winding number of every sample, from the ray map.
class WindingStage {
 public:
  WindingStage(Device& device, ScratchMemory* scratch);

  /// Reserves memory for grids of these dims and these modes; `Rays` and `Ray` need none. All previously
  /// recorded work must have completed.
  void reserve(const glm::ivec3& dims, SignMode mode, bool isSolvedToo);
  /// Counts the samples whose six rays disagree, and writes the mean of the rays of each sample, or the one
  /// along +x.
  void recordRays(Commands& commands, const LatticeLines& rays, SignMode mode, VkDeviceAddress winding);
  /// Replaces the mean if some rays disagree. The options give the number of passes and the offsets.
  void record(Commands& commands, const LatticeLines& rays, SignMode mode, const FieldOptions& options,
              VkDeviceAddress winding);
  /// Number of samples whose six rays disagree, one 32-bit number.
  const DeviceBuffer& doubtful() const { return rays_.doubtful(); }

 private:
  WindingRaysStage rays_;
  WindingPathsStage paths_;
  WindingHarmonicStage harmonic_;
};

}  // namespace raymap::vulkan
