#pragma once

#include <iterator>

#include "vulkan/stages/exact_distance_push.h"
#include "vulkan/stages/surface_tree.h"

namespace raymap::vulkan {

/// The CPU's twin: the distance, in cell units, of every sample to its closest triangle, and that triangle.
class ExactDistanceStage {
 public:
  /// What is written, of every sample.
  struct Fields {
    VkDeviceAddress distance = 0;
    VkDeviceAddress triangle = 0;  ///< 0: not asked for.
  };

  explicit ExactDistanceStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Makes room for a grid. Nothing recorded before may still have to run.
  void reserve(const glm::ivec3& dims);
  /// For the grid of the last `reserve` and the mesh last recorded in the tree. With a `band` above zero,
  /// samples farther than that get exactly `band` and `kNoTriangle`.
  void record(Commands& commands, const SurfaceTreeStage& tree, double band, const Fields& fields);
  /// The same for further triangles: samples that are closer to them than the distance there says get their
  /// distance, and `kNoTriangle`.
  void recordAddition(Commands& commands, const SurfaceTreeStage& tree, const Fields& fields);

 private:
  /// Blocks from large to small.
  static constexpr uint32_t kSides[] = {16, 8, 4};
  static constexpr uint32_t kSmallest = std::size(kSides) - 1;

  uint64_t blocks(uint32_t level) const;
  ExactDistancePush pushOf(const SurfaceTreeStage& tree, const Fields& fields) const;
  void recordBlocks(Commands& commands, ExactDistancePush push);
  void recordRest(Commands& commands, ExactDistancePush push);

  bool hasShortLoops_;
  uint32_t maxSubgroup_;
  uint32_t groupSize_;
  glm::ivec3 dims_{0};
  Kernel<ExactDistancePush> blocks_, samples_, rest_;
  DispatchArguments arguments_;
  DeviceBuffer lists_[kSmallest], unfinished_;
};

}  // namespace raymap::vulkan
