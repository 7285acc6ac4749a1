#pragma once

#include "vulkan/primitives/scan.h"
#include "vulkan/stages/cell_lattice.h"
#include "vulkan/stages/cell_runs_push.h"
#include "vulkan/stages/device_mesh.h"

namespace raymap::vulkan {

/// What was counted.
inline ListSizes sizesOf(const CellRunsTotals& totals) {
  return {.rows = uint64_t{totals.rowsHigh} << 32 | totals.rows,
          .entries = uint64_t{totals.entriesHigh} << 32 | totals.entries};
}

/// The CPU's twin: every run of cells along x that a triangle touches, by ascending triangles. A run for each
/// row of cells that the triangle's bounds touch; some are empty.
///
/// How many there are the device finds out, and writes to `totals`: where there is not room for them all, the
/// runs are undefined, and `fits` says so. Then reserve for as many, record and run it again.
class CellRunsStage {
 public:
  explicit CellRunsStage(Device& device);

  /// Makes room for so many triangles and for a guess at their rows, or so many if these are more. Nothing
  /// recorded before may still have to run. Throws `Error(Memory)` if there are more than can be numbered.
  void reserve(uint32_t triangles, uint64_t rows = 0);
  /// For no more triangles than were reserved.
  void record(Commands& commands, const DeviceMesh& mesh, const CellLattice& cells);

  bool fits(const ListSizes& sizes) const { return sizes.rows <= mostRows_; }

  /// By run; one more start than runs.
  VkDeviceAddress triangles() const { return runTriangles_.address(); }
  VkDeviceAddress firstCells() const { return runCells_.address(); }
  VkDeviceAddress starts() const { return runStarts_.address(); }
  /// One `CellRunsTotals`, for `sizesOf` when the work is done.
  const DeviceBuffer& totals() const { return totals_; }
  uint32_t mostRows() const { return mostRows_; }
  /// Groups of `kRunsGroup` runs, at least one.
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, const Push& push) const {
    arguments_.dispatch(commands, kernel, push, 0);
  }

 private:
  void reserveRows(uint32_t rows);

  Kernel<CellRunsPush> countRows_, findRuns_;
  Scan scan_;
  DispatchArguments arguments_;
  uint32_t mostTriangles_ = 0;
  uint32_t mostRows_ = 0;
  DeviceBuffer rowStarts_, runTriangles_, runCells_, runStarts_, totals_;
};

}  // namespace raymap::vulkan
