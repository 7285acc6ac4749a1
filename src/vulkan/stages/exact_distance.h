#pragma once

#include <iterator>

#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan/stages/exact_distance_push.h"
#include "vulkan/stages/surface_tree.h"

namespace raymap::vulkan {

/// GPU twin of cpu/distance/exact_distance.h. Computes every sample's distance, in cell units, to its closest
/// triangle, and the index of that triangle.
class ExactDistanceStage {
 public:
  /// Addresses of the results, one value per sample.
  struct Fields {
    VkDeviceAddress distance = 0;
    VkDeviceAddress triangle = 0;  ///< 0: not requested.
  };

  /// Properties of other devices, for tests.
  struct Imitated {
    uint32_t subgroups = 0;  ///< Subgroups per group: 1, 2 or 4; 0: what suits the device.
    int32_t rootError = 0;   ///< Units in the last place by which roots for bounds are off.
    uint32_t mostWork =
        0;  ///< Loop iterations from which on a block is heavy, 1: every one; 0: what suits the device.
  };

  explicit ExactDistanceStage(Device& device, ScratchMemory* scratch = nullptr)
      : ExactDistanceStage(device, scratch, Imitated{}) {}
  ExactDistanceStage(Device& device, ScratchMemory* scratch, const Imitated& imitated);

  /// Reserves memory for a grid. All previously recorded work must have completed.
  void reserve(const glm::ivec3& dims);
  /// Works on the grid of the last `reserve` and the mesh last recorded in the tree. If `band` is above zero,
  /// samples farther away get exactly `band` and `kNoTriangle`. An addition only changes samples closer to
  /// these triangles than their distance so far: they get the new distance and `kNoTriangle`.
  void record(Commands& commands, const SurfaceTreeStage& tree, double band, const Fields& fields,
              bool isAddition = false);

 private:
  /// Sides of the blocks in samples, from large to small.
  static constexpr uint32_t kSides[] = {16, 8, kBlockSide};
  static constexpr uint32_t kSmallest = std::size(kSides) - 1;

  uint64_t blocks(uint32_t level) const;
  void recordAlone(Commands& commands, ExactDistancePush push);
  uint64_t samples() const { return uint64_t(dims_.x) * uint64_t(dims_.y) * uint64_t(dims_.z); }
  /// Returns the work of a block from which on it is heavy.
  uint32_t heavyWork() const;

  bool hasShortLoops_;
  uint32_t heavyWork_;  // 0: depends on the grid.
  uint32_t maxSubgroup_;
  uint32_t groupSize_;
  glm::ivec3 dims_{0};
  Kernel<ExactDistancePush> blocks_, samples_, alone_, rest_;
  DispatchArguments aloneArguments_, restArguments_;
  DeviceBuffer lists_[kSmallest], heavy_, left_;
};

}  // namespace raymap::vulkan
