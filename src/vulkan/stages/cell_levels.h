#pragma once

#include <span>

#include "vulkan/stages/cell_distance.h"
#include "vulkan/stages/cell_levels_push.h"
#include "vulkan/stages/distance_transform.h"

namespace raymap::vulkan {

/// Returns the results of the stages before `refine` for one of the lattices of `coverMesh`.
CellLevelData levelOf(const VoxelGridStage& grid, const CellDistanceStage& distance,
                      const DistanceTransformStage& transform);

/// All levels, in a buffer for kernels.
class CellLevels {
 public:
  explicit CellLevels(Device& device);

  /// Reserves memory for at most `kMostLevels` levels. Their buffers must not be resized afterwards.
  void reserve(std::span<const CellLevelData> levels);
  void record(Commands& commands) const;

  VkDeviceAddress address() const { return levels_.address(); }
  uint32_t count() const { return static_cast<uint32_t>(levels_.bytes() / sizeof(CellLevelData)); }

 private:
  DeviceBuffer upload_, levels_;
};

}  // namespace raymap::vulkan
