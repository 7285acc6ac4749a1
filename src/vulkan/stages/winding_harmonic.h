#pragma once

#include <array>
#include <vector>

#include "method/winding_harmonic_lattices.h"
#include "vulkan/primitives/gate.h"
#include "vulkan/stages/winding_harmonic_push.h"
#include "vulkan/stages/winding_rays.h"

namespace raymap::vulkan {

/// The CPU's twin: the field that meets w(i) - w(i + 1) = w_l(i) on all lattice edges as well as possible, in
/// the least-squares sense, and vanishes far away.
class WindingHarmonicStage {
 public:
  explicit WindingHarmonicStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Makes room for grids of these dims. Nothing recorded before may still have to run.
  void reserve(const glm::ivec3& dims);
  /// For the grid of the last `reserve`.
  void record(Commands& commands, const WindingFields& fields);

 private:
  /// One lattice of the hierarchy. Its values and what its equations ask for: first of the solution and of
  /// the jumps; once the next finer one has started from that, of a correction and of the residual it is to
  /// mend. The finest one's values are the result, and what it asks for is not kept.
  struct Level {
    LatticeBox box;
    DeviceBuffer values, rightHandSide;
  };
  /// Where the arguments of a level's dispatches lie.
  enum class Extent : uint32_t { Samples, HalfSamples, RestrictGroups, OneGroup };
  static constexpr uint32_t kExtents = 4;
  static constexpr uint32_t kGroup = 128;

  void plan();
  void solve(Commands& commands, const WindingFields& fields, uint32_t level);
  void improve(Commands& commands, const WindingFields& fields, uint32_t level, VkDeviceAddress values,
               VkDeviceAddress rightHandSide);
  void solveCoarsest(Commands& commands, VkDeviceAddress values, VkDeviceAddress rightHandSide);
  void relax(Commands& commands, WindingHarmonicPush push);
  WindingHarmonicPush push(const WindingFields& fields, uint32_t level, VkDeviceAddress values) const;
  void dispatch(Commands& commands, Kernel<WindingHarmonicPush>& kernel, const WindingHarmonicPush& push,
                Extent extent) const;
  uint32_t coarsest() const { return static_cast<uint32_t>(levels_.size()) - 1; }

  Device* device_;
  ScratchMemory* scratch_;
  glm::ivec3 dims_{0};
  std::vector<Level> levels_;
  Gate gate_;
  Kernel<WindingHarmonicPush> jumps_, relax_, restrict_, correct_, prolong_, coarsest_;
};

}  // namespace raymap::vulkan
