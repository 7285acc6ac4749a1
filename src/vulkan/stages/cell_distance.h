#pragma once

#include "vulkan/stages/cell_distance_push.h"
#include "vulkan/stages/voxel_grid.h"

namespace raymap::vulkan {

/// GPU twin of cpu/cells/cell_distance.h. Computes the squared distance, in units of the lattice's cells,
/// from each occupied cell's centre to the triangles in the cell; `emptyCell` for all other cells.
class CellDistanceStage {
 public:
  explicit CellDistanceStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for a lattice. All previously recorded work must have completed.
  void reserve(const CellLattice& cells);
  /// Records the stage. The grid must have the lattice of the last `reserve`, and `mesh` must be the mesh it
  /// was built from.
  void record(Commands& commands, const DeviceMesh& mesh, const VoxelGridStage& grid);

  const DeviceBuffer& squared() const { return squared_; }

 private:
  LatticeKernel<CellDistancePush> kernel_;
  DeviceBuffer squared_;
};

}  // namespace raymap::vulkan
