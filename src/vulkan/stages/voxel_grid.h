#pragma once

#include "vulkan/primitives/radix_sort.h"
#include "vulkan/stages/cell_runs.h"
#include "vulkan/stages/voxel_grid_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/cells/voxel_grid.h: the triangles that touch each cell (§3.1, Fig. 2). Entries are pairs
/// of a cell and a triangle, in ascending order. The entries of cell c are consecutive and begin at
/// `begins[c]`, which is `kNoCell` for a cell without entries.
///
/// The device finds out the number of entries and writes it to `totals`. If the capacity does not suffice,
/// there are no entries and `fits` returns false. The caller then reserves that many, and records and runs
/// the stage again until `fits` returns true. It may take several runs: too many rows hide the number of
/// entries. Later meshes of about the same size fit at once.
class VoxelGridStage {
 public:
  explicit VoxelGridStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for a lattice, this many triangles and lists of an estimated length, or those of `lists`
  /// if they are longer. All previously recorded work must have completed. Throws `Error(Memory)` if the
  /// entries are too many to be numbered or stored.
  void reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists = {});
  /// Works on the lattice of the last `reserve`; the mesh must have at most as many triangles.
  void record(Commands& commands, const DeviceMesh& mesh);

  const DeviceBuffer& totals() const { return runs_.totals(); }
  bool fits(const ListSizes& sizes) const { return runs_.fits(sizes) && sizes.entries <= mostEntries_; }

  const CellLattice& lattice() const { return cells_; }
  /// One value per entry.
  const DeviceBuffer& cells() const { return entryCells_[0]; }
  const DeviceBuffer& triangles() const { return entryTriangles_[0]; }
  /// One value per cell.
  const DeviceBuffer& begins() const { return begins_; }
  /// Returns the number of entries; 0 if the capacity did not suffice.
  Count entryCount() const;
  /// Dispatches an invocation for each entry, in groups of `kRunsGroup`.
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
