#pragma once

#include "cell_lattice.h"
#include "scan.h"
#include "shared/cell_runs.h"

namespace raymap::vulkan {

/// The CPU's twin: every run of cells along x that a triangle touches, by ascending triangles. A run for each
/// row of cells that the triangle's bounds touch; some are empty.
///
/// How many there are the device finds out: where there is not room for them all, the runs are undefined, and
/// `fits` is false once the work is done. Then `grow`, record and run it again.
class CellRuns {
 public:
  /// Of a mesh in cell units.
  struct Triangles {
    VkDeviceAddress vertices = 0;   ///< Three floats each.
    VkDeviceAddress triangles = 0;  ///< Three indices each.
    uint32_t count = 0;
  };

  explicit CellRuns(Device& device);

  /// Makes room for so many triangles and a guess at their runs. Nothing recorded before may still have to
  /// run.
  void reserve(uint32_t triangles);
  void record(Commands& commands, const Triangles& triangles, const CellLattice& cells);

  /// After the work is done: how many rows, and how many cells with their repetitions.
  uint64_t rows() const;
  uint64_t entries() const;
  bool fits() const { return rows() <= mostRows_; }
  /// Makes room for the rows counted. Throws `Error(Memory)` if they cannot be numbered.
  void grow();

  /// By run; one more start than runs.
  VkDeviceAddress triangles() const { return runTriangles_.address(); }
  VkDeviceAddress firstCells() const { return runCells_.address(); }
  VkDeviceAddress starts() const { return runStarts_.address(); }
  /// `CellRunsTotals`.
  VkDeviceAddress totals() const { return totals_.address(); }
  uint32_t mostRows() const { return mostRows_; }
  /// Groups of `kRunsGroup` runs, at least one.
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, const Push& push) const {
    arguments_.dispatch(commands, kernel, push, 0);
  }

 private:
  CellRunsTotals counted() const;
  void reserveRows(uint32_t rows);

  Kernel<CellRunsPush> countRows_, findRuns_;
  Scan scan_;
  DispatchArguments arguments_;
  uint32_t mostTriangles_ = 0;
  uint32_t mostRows_ = 0;
  DeviceBuffer rowStarts_, runTriangles_, runCells_, runStarts_, totals_, readBack_;
};

}  // namespace raymap::vulkan
