#pragma once

#include "vulkan/stages/cell_distance_push.h"
#include "vulkan/stages/voxel_grid.h"

namespace raymap::vulkan {

/// The CPU's twin: the squared distance, in units of the lattice's cells, from each occupied cell's centre to
/// the triangles in it; `emptyCell` in all others.
class CellDistanceStage {
 public:
  explicit CellDistanceStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Makes room for lattices of so many cells. Nothing recorded before may still have to run.
  void reserve(size_t cells);
  /// For a grid of as many cells as were reserved, and the triangles that it was made of.
  void record(Commands& commands, const DeviceMesh& mesh, const VoxelGridStage& grid);

  const DeviceBuffer& squared() const { return squared_; }

 private:
  Kernel<CellDistancePush> kernel_;
  DeviceBuffer squared_;
};

}  // namespace raymap::vulkan
