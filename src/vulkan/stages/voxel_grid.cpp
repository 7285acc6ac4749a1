// Krayer & Müller 2019, §3.1, Fig. 2.
//
// Paper: the rasterizer distributes the work; an atomic counter per cell, a prefix sum over all cells, an
// atomic slot for each triangle. Here: an invocation finds the rows of cells of a small triangle, a group
// those of a part of a large one, and a subgroup lists a long row's cells together. The counter gives each
// pair its slot, and the first pair of a cell takes the memory of the cell's list, so no sum over the cells
// is needed. A kernel of its own decides, with doubles in software, the rows for which floats do not suffice.

#include "vulkan/stages/voxel_grid.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstddef>
#include <string>

#include "method/cell_lattice.h"
#include "shaders/voxel_grid_begins_spv.h"
#include "shaders/voxel_grid_entries_spv.h"
#include "shaders/voxel_grid_exact_spv.h"
#include "shaders/voxel_grid_parts_spv.h"
#include "shaders/voxel_grid_spv.h"

namespace raymap::vulkan {

namespace {

static_assert(offsetof(VoxelGridTotals, rows) == sizeof(uint32_t) * kRowsWord &&
              offsetof(VoxelGridTotals, pairs) == sizeof(uint32_t) * kPairsWord &&
              offsetof(VoxelGridTotals, parts) == sizeof(uint32_t) * kPartsWord &&
              offsetof(VoxelGridTotals, openRows) == sizeof(uint32_t) * kOpenRowsWord &&
              offsetof(VoxelGridTotals, entries) == sizeof(uint32_t) * kEntriesWord);

constexpr uint32_t kMostRows = uint32_t{1} << 30;
constexpr uint32_t kMostPairs = uint32_t{1} << 30;

/// Returns what to reserve: somewhat more than was counted, and at least a guess.
uint32_t capacity(uint32_t now, uint64_t counted, uint64_t guess, uint32_t most) {
  return std::max(now,
                  static_cast<uint32_t>(std::min<uint64_t>(most, std::max(counted + counted / 8, guess))));
}

}  // namespace

VoxelGridStage::VoxelGridStage(Device& device, ScratchMemory* scratch)
    : ofTriangles_(device, shaders::kVoxelGrid, kGroup),
      ofParts_(device, shaders::kVoxelGridParts, std::max(kPartRows, device.limits().maxSubgroupSize)),
      exact_(device, shaders::kVoxelGridExact, kOpenRowsGroup),
      findBegins_(device, shaders::kVoxelGridBegins, kGroup),
      writeEntries_(device, shaders::kVoxelGridEntries, kGroup),
      partArguments_(device, "dispatches of large triangles"),
      openArguments_(device, "dispatches of cell rows to find exactly"),
      pairArguments_(device, "dispatches of pairs of cell and triangle"),
      totals_(device, "voxel grid's totals"),
      rows_(device, "cell rows of large triangles and to find exactly"),
      cells_(device, "pairs' cells"),
      touching_(device, "pairs' triangles"),
      places_(device, "pairs' places"),
      begins_(device, "cells' first entries", scratch),
      entryCells_(device, "entries' cells"),
      entryTriangles_(device, "entries' triangles") {}

void VoxelGridStage::reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists,
                             bool hasLists) {
  // In fine meshes a triangle touches about two rows and two cells. The minimums are negligible work.
  constexpr uint64_t kRowsPerTriangle = 3, kSomeRows = uint64_t{1} << 16;
  constexpr uint64_t kPairsPerTriangle = 4, kSomePairs = uint64_t{1} << 17;
  if (lists.rows > kMostRows)
    throw Error(ErrorCode::Memory, "the triangles touch " + std::to_string(lists.rows) +
                                       " rows of cells, the device can number " + std::to_string(kMostRows) +
                                       "; use a lower resolution, exact distance or the CPU");
  if (lists.entries > kMostPairs)
    throw Error(ErrorCode::Memory, "the cells' triangle lists hold " + std::to_string(lists.entries) +
                                       " entries, the device can number " + std::to_string(kMostPairs) +
                                       "; use a lower resolution or exact distance");
  lattice_ = cells;
  hasLists_ = hasLists;
  for (auto* kernel : {&ofTriangles_, &ofParts_, &exact_}) kernel->choose(isOfSamples(cells));
  totals_.resize<VoxelGridTotals>(1);
  begins_.resize<uint32_t>(hasLists ? cells.count() : 0);
  const uint32_t rows = capacity(mostRows_, lists.rows, kRowsPerTriangle * triangles + kSomeRows, kMostRows);
  rows_.resize<uint64_t>(uint64_t{mostParts(rows)} + rows);
  partArguments_.reserve({.most = mostParts(rows)});
  openArguments_.reserve({.most = rows, .itemsPerGroup = kOpenRowsGroup / kOpenRowLanes});
  mostRows_ = rows;
  const uint32_t pairs =
      capacity(mostPairs_, lists.entries, kPairsPerTriangle * triangles + kSomePairs, kMostPairs);
  for (DeviceBuffer* each : {&cells_, &touching_}) each->resize<uint32_t>(pairs);
  for (DeviceBuffer* each : {&places_, &entryCells_, &entryTriangles_})
    each->resize<uint32_t>(hasLists_ ? pairs : 0);
  pairArguments_.reserve({.most = pairs, .itemsPerGroup = kGroup});
  mostPairs_ = pairs;
}

VkDeviceAddress VoxelGridStage::entryCount() const {
  return totals_.address() + sizeof(uint32_t) * (hasLists_ ? kEntriesWord : kPairsWord);
}

void VoxelGridStage::record(Commands& commands, const DeviceMesh& mesh) {
  recordPairs(commands, mesh);
  if (hasLists_) recordLists(commands);
}

void VoxelGridStage::recordPairs(Commands& commands, const DeviceMesh& mesh) {
  const auto counted = [&](uint32_t word) { return totals_.address() + sizeof(uint32_t) * word; };
  const VoxelGridPush push{.vertices = mesh.vertices,
                           .triangles = mesh.triangles,
                           .totals = totals_.address(),
                           .rows = rows_.address(),
                           .cells = cells_.address(),
                           .touching = touching_.address(),
                           .places = hasLists_ ? places_.address() : 0,
                           .begins = hasLists_ ? begins_.address() : 0,
                           .lattice = latticeOf(lattice_),
                           .triangleCount = mesh.triangleCount,
                           .mostRows = mostRows_,
                           .mostPairs = mostPairs_};
  commands.concurrent([&] {
    commands.fill(totals_, 0);
    if (hasLists_) commands.fill(begins_, kNoCell);
  });
  commands.dispatch(*ofTriangles_, push, mesh.triangleCount);
  partArguments_.record(commands, counted(kPartsWord));
  partArguments_.dispatch(commands, *ofParts_, push);
  openArguments_.record(commands, counted(kOpenRowsWord));
  openArguments_.dispatch(commands, *exact_, push);
  pairArguments_.record(commands, counted(kPairsWord));
}

void VoxelGridStage::recordLists(Commands& commands) {
  const VoxelGridListsPush push{.totals = totals_.address(),
                                .cells = cells_.address(),
                                .touching = touching_.address(),
                                .places = places_.address(),
                                .begins = begins_.address(),
                                .entryCells = entryCells_.address(),
                                .entryTriangles = entryTriangles_.address(),
                                .mostRows = mostRows_,
                                .mostPairs = mostPairs_};
  dispatch(commands, findBegins_, push);
  dispatch(commands, writeEntries_, push);
}

}  // namespace raymap::vulkan
