#pragma once

#include <vector>

#include "method/winding_rims_lattices.h"
#include "vulkan/stages/crossings.h"
#include "vulkan/stages/winding_harmonic_push.h"
#include "vulkan/stages/winding_rims_push.h"

namespace raymap::vulkan {

/// In single precision, a number from more rims is less exact than one from dipoles.
inline constexpr size_t kMostRimsInSingles = 4096;

/// GPU twin of cpu/sign/winding_rims_samples.h: winding numbers that follow from rays and rims.
class WindingRimsStage {
 public:
  explicit WindingRimsStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for grids of these dims. All previously recorded work must have completed.
  void reserve(const glm::ivec3& dims);
  /// Fills `winding` on the grid of the last `reserve`, if all numbers follow from rims. All previously
  /// recorded work must have completed.
  void record(Commands& commands, const LatticeLines& rays, const RimLattices& lattices,
              VkDeviceAddress winding);
  /// Computes the numbers exactly that may lie on the wrong side of the threshold, with the rims of the last
  /// `record`. `distance` is the unsigned distance in cells, and `change` that of `WindingDoubtsStage`. Where
  /// dipoles have decided, `change` is 0: then it computes the numbers that equal the threshold.
  void recordSettling(Commands& commands, const LatticeLines& rays, VkDeviceAddress distance,
                      VkDeviceAddress change, double threshold, VkDeviceAddress winding);

 private:
  void upload(Commands& commands, const RimLattices& lattices);
  WindingRimsPush push(const LatticeLines& rays, VkDeviceAddress values) const;

  glm::ivec3 dims_{0};
  Device* device_;
  ScratchMemory* scratch_;
  uint32_t rimCount_ = 0, source_ = kFromRims;
  glm::vec3 centre_{0.0f};
  std::vector<DeviceBuffer> values_;  // Of the coarser lattices.
  DeviceBuffer upload_, lists_;       // Rims, then the places of each lattice's samples.
  Kernel<WindingHarmonicPush> prolong_;
  Kernel<WindingRimsPush> listed_, settle_;
  uint32_t lanes_;  // A subgroup computes a sample, of at most so many lanes.
};

}  // namespace raymap::vulkan
