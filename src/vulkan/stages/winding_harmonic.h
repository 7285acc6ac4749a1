#pragma once

#include <array>
#include <vector>

#include "method/winding_harmonic_lattices.h"
#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan/stages/winding_harmonic_push.h"
#include "vulkan/stages/winding_rays.h"

namespace raymap::vulkan {

/// GPU twin of cpu/sign/winding_harmonic.h. Computes the field that meets w(i) - w(i + 1) = w_l(i) on all
/// lattice edges best in the least-squares sense, and vanishes far away.
class WindingHarmonicStage {
 public:
  explicit WindingHarmonicStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for grids of these dims. All previously recorded work must have completed.
  void reserve(const glm::ivec3& dims);
  /// Works on the grid of the last `reserve`.
  void record(Commands& commands, const WindingFields& fields);

 private:
  /// One lattice of the hierarchy, with values and right-hand side. At first these are the solution and, of
  /// the two coarsest, the jumps. After the next finer lattice has started from the solution, they are a
  /// correction and the residual that it reduces. The finest lattice's values are the result.
  struct Level {
    LatticeBox box;
    DeviceBuffer values, rightHandSide;
  };
  /// Sizes of dispatches, which index a level's arguments.
  enum class Extent : uint32_t { Samples, HalfSamples, RestrictGroups, OneGroup };
  static constexpr uint32_t kExtents = 4;

  void plan();
  void improve(Commands& commands, const WindingFields& fields, uint32_t level, uint32_t firstColour);
  void solveCoarse(Commands& commands, const WindingFields& fields, uint32_t firstColour);
  void relax(Commands& commands, WindingHarmonicPush push, uint32_t firstColour);
  WindingHarmonicPush push(const WindingFields& fields, uint32_t level) const;
  void dispatch(Commands& commands, Kernel<WindingHarmonicPush>& kernel, const WindingHarmonicPush& push,
                Extent extent);
  void report(Commands& commands, uint32_t level, Extent extent);
  /// The finer one of the two lattices that one group solves.
  uint32_t coarse() const { return static_cast<uint32_t>(levels_.size()) - 2; }

  Device* device_;
  ScratchMemory* scratch_;
  glm::ivec3 dims_{0};
  std::vector<Level> levels_;
  double work_ = 0.0, done_ = 0.0;  // Samples that a whole solve visits, and those visited so far.
  DispatchArguments gate_;
  Kernel<WindingHarmonicPush> relax_, restrict_, correct_, prolong_, coarse_;
};

}  // namespace raymap::vulkan
