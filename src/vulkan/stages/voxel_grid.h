#pragma once

#include "vulkan/primitives/radix_sort.h"
#include "vulkan/stages/cell_runs.h"
#include "vulkan/stages/voxel_grid_push.h"

namespace raymap::vulkan {

/// The CPU's twin: which triangles touch which cell (§3.1, Fig. 2). Entries are pairs of a cell and a
/// triangle, in ascending order: cell c's begin at `begins[c]`, `kNoCell` if it has none, and go on as long
/// as entries are of c.
///
/// How many there are the device finds out, and writes to `totals`: where there is not room for them all,
/// there will be none, and `fits` says so. Then reserve for as many, record and run it again until it says
/// yes (too many rows hide how many entries there are); later meshes of about the same size fit at once.
class VoxelGridStage {
 public:
  explicit VoxelGridStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Makes room for a lattice and so many triangles, and for a guess at their lists, or such if these are
  /// longer. Nothing recorded before may still have to run. Throws `Error(Memory)` if there are more entries
  /// than can be numbered or had.
  void reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists = {});
  /// For the lattice of the last `reserve`, and no more triangles.
  void record(Commands& commands, const DeviceMesh& mesh);

  const DeviceBuffer& totals() const { return runs_.totals(); }
  bool fits(const ListSizes& sizes) const { return runs_.fits(sizes) && sizes.entries <= mostEntries_; }

  const CellLattice& lattice() const { return cells_; }
  /// By entry.
  const DeviceBuffer& cells() const { return entryCells_[0]; }
  const DeviceBuffer& triangles() const { return entryTriangles_[0]; }
  /// By cell.
  const DeviceBuffer& begins() const { return begins_; }
  /// How many entries there are: none where there is not room for them.
  Count entryCount() const;
  /// An invocation for each entry, in groups of `kRunsGroup`.
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, const Push& push) const {
    arguments_.dispatch(commands, kernel, push, 0);
  }

 private:
  void reserveEntries(uint32_t entries);
  RadixSort::Pairs pairs(size_t place) const;

  CellLattice cells_;
  CellRunsStage runs_;
  Kernel<VoxelGridPush> writeEntries_, findBegins_;
  RadixSort sort_;
  DispatchArguments arguments_;
  uint32_t mostEntries_ = 0;
  DeviceBuffer entryCells_[2], entryTriangles_[2], begins_, count_;
};

}  // namespace raymap::vulkan
