#pragma once

#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan/stages/device_mesh.h"
#include "vulkan/stages/lattice_kernel.h"
#include "vulkan/stages/voxel_grid_push.h"

namespace raymap::vulkan {

/// Returns the counted sizes.
inline ListSizes sizesOf(const VoxelGridTotals& totals) {
  return {.rows = uint64_t{totals.rowsHigh} << 32 | totals.rows,
          .entries = uint64_t{totals.pairsHigh} << 32 | totals.pairs};
}

/// GPU twin of cpu/cells/voxel_grid.h: the triangles that touch each cell (§3.1, Fig. 2). Entries are pairs
/// of a cell and a triangle. The entries of cell c are consecutive and begin at `begins[c]`, which is
/// `kNoCell` for a cell without entries. The order of the lists, and that within each, may change from run to
/// run; nothing that is computed from them does.
///
/// The device finds out the number of entries and writes it to `totals`. If the capacity does not suffice,
/// there are no entries and `fits` returns false. The caller then reserves that many, and records and runs
/// the stage again until `fits` returns true. It may take several runs: too many rows hide the number of
/// entries. Later meshes of about the same size fit at once.
class VoxelGridStage {
 public:
  explicit VoxelGridStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for a lattice, this many triangles and lists of an estimated length, or those of `lists`
  /// if they are longer. Without `hasLists` there are entries, in no particular order, but no `begins`. All
  /// previously recorded work must have completed. Throws `Error(Memory)` if the entries are too many to be
  /// numbered or stored.
  void reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists = {},
               bool hasLists = true);
  /// Works on the lattice of the last `reserve`; the mesh must have at most as many triangles.
  void record(Commands& commands, const DeviceMesh& mesh);

  /// Buffer of one `VoxelGridTotals`, for `sizesOf` when the work is done.
  const DeviceBuffer& totals() const { return totals_; }
  bool fits(const ListSizes& sizes) const { return sizes.rows <= mostRows_ && sizes.entries <= mostPairs_; }

  const CellLattice& lattice() const { return lattice_; }
  /// One value per entry.
  const DeviceBuffer& cells() const { return hasLists_ ? entryCells_ : cells_; }
  const DeviceBuffer& triangles() const { return hasLists_ ? entryTriangles_ : touching_; }
  /// One value per cell; empty without lists.
  const DeviceBuffer& begins() const { return begins_; }
  /// Returns the address of the number of entries, which is 0 if the capacity of lists did not suffice.
  VkDeviceAddress entryCount() const;
  uint32_t mostEntries() const { return mostPairs_; }
  /// Dispatches an invocation for each entry, in groups of `kGroup`.
  template <class Push>
  void dispatch(Commands& commands, Kernel<Push>& kernel, const Push& push) const {
    pairArguments_.dispatch(commands, kernel, push);
  }

 private:
  void recordPairs(Commands& commands, const DeviceMesh& mesh);
  void recordLists(Commands& commands);

  CellLattice lattice_;
  bool hasLists_ = true;
  LatticeKernel<VoxelGridPush> ofTriangles_, ofParts_, exact_;
  Kernel<VoxelGridListsPush> findBegins_, writeEntries_;
  DispatchArguments partArguments_, openArguments_, pairArguments_;
  uint32_t mostRows_ = 0;
  uint32_t mostPairs_ = 0;
  DeviceBuffer totals_, rows_, cells_, touching_, places_, begins_, entryCells_, entryTriangles_;
};

}  // namespace raymap::vulkan
