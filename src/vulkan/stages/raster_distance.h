#pragma once

#include "vulkan/stages/cell_levels.h"
#include "vulkan/stages/cell_runs.h"
#include "vulkan/stages/raster_distance_push.h"
#include "vulkan/stages/raster_distance_samples_push.h"

namespace raymap::vulkan {

/// The CPU's twin (the last paragraph of §3.3): each triangle writes its squared distance, in units of the
/// lattice's cells, into the cells it touches, keeping the minimum; `emptyCell` in all others.
///
/// How many rows of cells there are the device finds out, and writes to `totals`: where there is not room for
/// them all, the distances are undefined, and `fits` says so. Then reserve for as many, record and run it
/// again.
class RasterDistanceStage {
 public:
  explicit RasterDistanceStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Makes room for a lattice and so many triangles, and for a guess at their rows, or so many if these are
  /// more. Nothing recorded before may still have to run. Throws `Error(Memory)` if there are more than can
  /// be numbered or had.
  void reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists = {});
  /// For the lattice of the last `reserve`, and no more triangles.
  void record(Commands& commands, const DeviceMesh& mesh);

  const DeviceBuffer& totals() const { return runs_.totals(); }
  bool fits(const ListSizes& sizes) const { return runs_.fits(sizes); }

  const DeviceBuffer& squared() const { return squared_; }
  /// For `RasterSamples`, after the transform.
  CellLevelData level(const DistanceTransformStage& transform) const;

 private:
  CellLattice cells_;
  CellRunsStage runs_;
  Kernel<RasterDistancePush> kernel_;
  DeviceBuffer squared_;
};

/// The distance, in sample units, of every sample after the distance transform of each level.
class RasterDistanceSamplesStage {
 public:
  explicit RasterDistanceSamplesStage(Device& device);

  /// For grids of these dims, and levels whose stages have made their room. Nothing recorded before may still
  /// have to run.
  void reserve(const glm::ivec3& dims, std::span<const CellLevelData> levels);
  void record(Commands& commands, VkDeviceAddress distance);

 private:
  glm::uvec3 dims_{0};
  Kernel<RasterSamplesPush> kernel_;
  CellLevels levels_;
};

}  // namespace raymap::vulkan
