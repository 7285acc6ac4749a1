#pragma once

#include <glm/glm.hpp>

#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan/stages/surface_tree.h"
#include "vulkan/stages/winding_dipoles_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/sign/winding_dipoles.h. Computes winding numbers of the triangles themselves, by a tree of
/// dipoles (Barill et al. 2018), for samples whose number on the lattice is close to the threshold. If there
/// is none, only the search for such samples runs.
class WindingDipolesStage {
 public:
  struct Fields {
    VkDeviceAddress distance = 0;  ///< Unsigned, in cells.
    VkDeviceAddress winding = 0;
    VkDeviceAddress disagreeing = 0;  ///< Number of samples whose rays disagree; if 0, no winding number
                                      ///< changes.
    VkDeviceAddress change = 0;       ///< See `WindingDoubtsStage`.
  };
  /// How many looks a sample gets at most, and whether rims decide where the last one is not sure. These
  /// numbers then equal the threshold.
  struct Looks {
    uint32_t most = kLooks;
    bool rimsDecide = false;
  };

  /// A group of this many invocations computes a winding number, a multiple of `kTreeArity`. Without it, the
  /// device decides. Results do not depend on it.
  explicit WindingDipolesStage(Device& device, ScratchMemory* scratch = nullptr, uint32_t invocations = 0);

  /// Reserves memory for trees of up to this many triangles and grids of these dims. All previously recorded
  /// work must have completed.
  void reserve(uint32_t triangleCount, const glm::ivec3& dims);
  void record(Commands& commands, const SurfaceTreeStage& tree, const Fields& fields, Looks looks,
              double threshold);
  /// Computes the winding numbers at `count` points of three coordinates each. Writes the threshold for a
  /// point that takes too long.
  void recordNumbersAt(Commands& commands, const SurfaceTreeStage& tree, VkDeviceAddress points,
                       uint32_t count, VkDeviceAddress numbers, double threshold);

 private:
  uint64_t mostListed() const;
  WindingDipolesPush pushOf(const SurfaceTreeStage& tree, double threshold) const;
  /// Works on each level, from the leaves on.
  void recordMoments(Commands& commands, const SurfaceTreeStage& tree, WindingDipolesPush push, bool isGated);

  uint32_t invocations_;
  glm::ivec3 dims_{0};
  DispatchArguments gate_;
  Kernel<WindingDipolesPush> doubts_, momentsOf_, settle_, points_;
  DispatchArguments arguments_;
  uint32_t mostTurns_;
  DeviceBuffer moments_, doubtful_;
};

}  // namespace raymap::vulkan
