#pragma once

#include <glm/glm.hpp>

#include "vulkan/primitives/gate.h"
#include "vulkan/stages/surface_tree.h"
#include "vulkan/stages/winding_dipoles_push.h"

namespace raymap::vulkan {

/// The CPU's twin: winding numbers of the triangles themselves, by a tree of dipoles (Barill et al. 2018),
/// where the lattice comes close to the threshold. Nothing runs where it does not.
class WindingDipolesStage {
 public:
  struct Fields {
    VkDeviceAddress distance = 0;  ///< Unsigned, in cells.
    VkDeviceAddress winding = 0;
    VkDeviceAddress disagreeing = 0;  ///< How many samples' rays disagree: where none do, nothing runs.
  };

  explicit WindingDipolesStage(Device& device);

  /// Makes room for trees of up to so many triangles and grids of these dims. Nothing recorded before may
  /// still have to run.
  void reserve(uint32_t triangleCount, const glm::ivec3& dims);
  void record(Commands& commands, const SurfaceTreeStage& tree, const Fields& fields, double threshold);
  /// The winding numbers at so many points, of three coordinates each; the threshold where one takes too
  /// long.
  void recordNumbersAt(Commands& commands, const SurfaceTreeStage& tree, VkDeviceAddress points,
                       uint32_t count, VkDeviceAddress numbers, double threshold);

 private:
  WindingDipolesPush pushOf(const SurfaceTreeStage& tree, double threshold) const;
  /// Calls `dispatch(push, level)` for each level from the leaves on.
  template <class Dispatch>
  void recordMoments(const SurfaceTreeStage& tree, WindingDipolesPush push, Dispatch&& dispatch);

  glm::ivec3 dims_{0};
  uint32_t mostLevels_ = 0;
  Gate gate_;
  Kernel<WindingDipolesPush> doubts_, momentsOf_, settle_, points_;
  uint32_t mostTurns_;
  DeviceBuffer moments_, doubtful_;
};

}  // namespace raymap::vulkan
