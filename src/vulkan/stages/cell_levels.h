#pragma once

#include <span>

#include "vulkan/stages/cell_distance.h"
#include "vulkan/stages/cell_levels_push.h"
#include "vulkan/stages/distance_transform.h"

namespace raymap::vulkan {

/// Stages before `refine`, for one of the lattices of `coverMesh`.
struct CellStages {
  explicit CellStages(Device& device, ScratchMemory* scratch = nullptr)
      : grid(device, scratch), distance(device, scratch), transform(device, scratch) {}

  void reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists, bool hasLists = true);
  /// Returns the results for kernels.
  CellLevelData data() const;

  VoxelGridStage grid;
  CellDistanceStage distance;
  DistanceTransformStage transform;
};

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
