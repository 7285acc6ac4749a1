#pragma once

#include "vulkan/primitives/scan.h"
#include "vulkan/stages/cell_runs_push.h"
#include "vulkan/stages/device_mesh.h"
#include "vulkan/stages/lattice_kernel.h"

namespace raymap::vulkan {

/// Returns the counted sizes.
inline ListSizes sizesOf(const CellRunsTotals& totals) {
  return {.rows = uint64_t{totals.rowsHigh} << 32 | totals.rows,
          .entries = uint64_t{totals.entriesHigh} << 32 | totals.entries};
}

/// GPU twin of cpu/cells/cell_runs.h. Finds every run of cells along x that a triangle touches, by ascending
/// triangles. There is one run for each row of cells in the triangle's bounds; some are empty.
///
/// The device finds out the number of runs and writes it to `totals`. If the capacity does not suffice, the
/// runs are undefined and `fits` returns false. The caller then reserves that many, and records and runs the
/// stage again.
class CellRunsStage {
 public:
  explicit CellRunsStage(Device& device);

  /// Reserves memory for a lattice, this many triangles and an estimated number of rows, or for `rows` if
  /// that is more. All previously recorded work must have completed. Throws `Error(Memory)` if the rows are
  /// too many to be numbered.
  void reserve(const CellLattice& cells, uint32_t triangles, uint64_t rows = 0);
  /// Works on the lattice of the last `reserve`; the mesh must have at most as many triangles.
  void record(Commands& commands, const DeviceMesh& mesh);

  bool fits(const ListSizes& sizes) const { return sizes.rows <= mostRows_; }

  /// Addresses of the runs; there is one more start than runs.
  VkDeviceAddress triangles() const { return runTriangles_.address(); }
  VkDeviceAddress firstCells() const { return runCells_.address(); }
  VkDeviceAddress starts() const { return runStarts_.address(); }
  /// Buffer of one `CellRunsTotals`, for `sizesOf` when the work is done.
  const DeviceBuffer& totals() const { return totals_; }
  uint32_t mostRows() const { return mostRows_; }
  /// Dispatches groups of `kRunsGroup` runs, at least one.
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, const Push& push) const {
    arguments_.dispatch(commands, kernel, push, 0);
  }

 private:
  void reserveRows(uint32_t rows);

  CellLattice cells_;
  LatticeKernel<CellRunsPush> countRows_, findRuns_, findUnknown_;
  Scan scan_;
  DispatchArguments arguments_;
  uint32_t mostTriangles_ = 0;
  uint32_t mostRows_ = 0;
  DeviceBuffer rowStarts_, runTriangles_, runCells_, runStarts_, unknown_, unknownCount_, totals_;
};

}  // namespace raymap::vulkan
