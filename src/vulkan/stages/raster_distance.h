#pragma once

#include "vulkan/stages/cell_levels.h"
#include "vulkan/stages/cell_runs.h"
#include "vulkan/stages/raster_distance_push.h"
#include "vulkan/stages/raster_distance_samples_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/cells/raster_distance.h (the last paragraph of §3.3). Each triangle writes its squared
/// distance, in units of the lattice's cells, into the cells it touches; the minimum stays. All other cells
/// get `emptyCell`.
///
/// The device finds out the number of rows of cells and writes it to `totals`. If the capacity does not
/// suffice, the distances are undefined and `fits` returns false. The caller then reserves that many, and
/// records and runs the stage again.
class RasterDistanceStage {
 public:
  explicit RasterDistanceStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for a lattice, this many triangles and an estimated number of rows, or for those of
  /// `lists` if that is more. All previously recorded work must have completed. Throws `Error(Memory)` if the
  /// rows are too many to be numbered or stored.
  void reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists = {});
  /// Works on the lattice of the last `reserve`; the mesh must have at most as many triangles.
  void record(Commands& commands, const DeviceMesh& mesh);

  const DeviceBuffer& totals() const { return runs_.totals(); }
  bool fits(const ListSizes& sizes) const { return runs_.fits(sizes); }

  const DeviceBuffer& squared() const { return squared_; }
  /// Returns the level for `RasterDistanceSamplesStage`, after the transform.
  CellLevelData level(const DistanceTransformStage& transform) const;

 private:
  CellLattice cells_;
  CellRunsStage runs_;
  LatticeKernel<RasterDistancePush> kernel_;
  DeviceBuffer squared_;
};

/// Computes the distance, in sample units, of every sample after the distance transform of each level.
class RasterDistanceSamplesStage {
 public:
  explicit RasterDistanceSamplesStage(Device& device);

  /// Prepares for grids of these dims and these levels, whose stages must have reserved their memory. All
  /// previously recorded work must have completed.
  void reserve(const glm::ivec3& dims, std::span<const CellLevelData> levels);
  void record(Commands& commands, VkDeviceAddress distance);

 private:
  glm::uvec3 dims_{0};
  LatticeKernel<RasterSamplesPush> kernel_;
  CellLevels levels_;
};

}  // namespace raymap::vulkan
