// Krayer & Müller 2019, §3.1, Fig. 2.
//
// Paper: an atomic counter per cell, a prefix sum over all cells, an atomic slot for each triangle. Here:
// pairs of cell and triangle, written by ascending triangles and sorted stably by cell. Each list is then in
// ascending order, independently of the order of groups. A cell that holds all triangles costs no more than
// others.

#include "vulkan/stages/voxel_grid.h"

#include <raymap/error.h>

#include <algorithm>
#include <bit>
#include <string>

#include "method/cell_lattice.h"
#include "shaders/voxel_grid_begins_spv.h"
#include "shaders/voxel_grid_entries_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kMostEntries = uint32_t{1} << 30;

uint32_t bitsOf(const CellLattice& cells) {
  return static_cast<uint32_t>(std::bit_width(cells.count() - 1));
}

}  // namespace

VoxelGridStage::VoxelGridStage(Device& device, ScratchMemory* scratch)
    : runs_(device),
      writeEntries_(device, shaders::kVoxelGridEntries, kRunsGroup),
      findBegins_(device, shaders::kVoxelGridBegins, kRunsGroup),
      sort_(device),
      arguments_(device, "voxel grid arguments", 1),
      entryCells_{{device, "entries' cells"}, {device, "entries' cells, unsorted"}},
      entryTriangles_{{device, "entries' triangles"}, {device, "entries' triangles, unsorted"}},
      begins_(device, "cells' first entries", scratch),
      count_(device, "entries' count") {}

void VoxelGridStage::reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists) {
  // Twice what a fine mesh has. The minimum is negligible work.
  constexpr uint64_t kEntriesPerTriangle = 4, kFewEntries = uint64_t{1} << 17;
  if (lists.entries > kMostEntries)
    throw Error(ErrorCode::Memory, "the cells' triangle lists hold " + std::to_string(lists.entries) +
                                       " entries, the device can sort " + std::to_string(kMostEntries) +
                                       "; use a lower resolution or exact distance");
  const uint64_t wanted =
      std::max(lists.entries + lists.entries / 8, kEntriesPerTriangle * triangles + kFewEntries);
  cells_ = cells;
  runs_.reserve(cells, triangles, lists.rows);
  begins_.resize<uint32_t>(cells.count());
  count_.resize<uint32_t>(1);
  reserveEntries(std::max(mostEntries_, static_cast<uint32_t>(std::min<uint64_t>(kMostEntries, wanted))));
}

void VoxelGridStage::reserveEntries(uint32_t entries) {
  sort_.reserve(entries);
  for (size_t place : {0, 1}) {
    entryCells_[place].resize<uint32_t>(entries);
    entryTriangles_[place].resize<uint32_t>(entries);
  }
  mostEntries_ = entries;
}

Count VoxelGridStage::entryCount() const {
  return {.most = mostEntries_, .address = count_.address()};
}

RadixSort::Pairs VoxelGridStage::pairs(size_t place) const {
  return {entryCells_[place].address(), entryTriangles_[place].address()};
}

void VoxelGridStage::record(Commands& commands, const DeviceMesh& mesh) {
  runs_.record(commands, mesh);
  // Chosen so that the sorted pairs end in place 0.
  const size_t unsorted = (bitsOf(cells_) + kRadixBits - 1) / kRadixBits % 2;
  VoxelGridPush push{.runTriangles = runs_.triangles(),
                     .runCells = runs_.firstCells(),
                     .runStarts = runs_.starts(),
                     .totals = runs_.totals().address(),
                     .cells = entryCells_[unsorted].address(),
                     .triangles = entryTriangles_[unsorted].address(),
                     .begins = begins_.address(),
                     .count = count_.address(),
                     .mostRows = runs_.mostRows(),
                     .mostEntries = mostEntries_};
  runs_.dispatch(commands, writeEntries_, push);
  sort_.record(commands, pairs(unsorted), pairs(1 - unsorted), entryCount(), bitsOf(cells_));
  commands.fill(begins_, kNoCell);
  push.cells = entryCells_[0].address();
  push.triangles = entryTriangles_[0].address();
  arguments_.record(commands, 0, {.count = entryCount(), .itemsPerGroup = kRunsGroup});
  arguments_.dispatch(commands, findBegins_, push, 0);
}

}  // namespace raymap::vulkan
