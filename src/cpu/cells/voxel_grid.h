#pragma once

#include "base/progress.h"
#include "method/cell_lattice.h"

#include <vector>

namespace raymap::cpu {

/// Triangles that touch each cell (§3.1, Fig. 2): cell c holds `triangles[starts[c] .. starts[c + 1])`, in
/// ascending order.
struct VoxelGrid {
  CellLattice cells;
  Buffer<uint64_t> starts;
  Buffer<uint32_t> triangles;

  std::span<const uint32_t> list(size_t cell) const {
    return {triangles.data() + starts[cell], triangles.data() + starts[cell + 1]};
  }
  size_t bytes() const { return starts.capacityBytes() + triangles.capacityBytes(); }
  /// Returns the bytes of lists for a fine mesh, whose triangles touch few cells each.
  static size_t bytesExpected(size_t cells, size_t triangles) {
    constexpr size_t kCellsOfTriangle = 8;
    return (cells + 1) * sizeof(uint64_t) + kCellsOfTriangle * triangles * sizeof(uint32_t);
  }
};

/// Builds the lists by counting, an exclusive prefix sum and filling. Throws `Error(Memory)` if they need
/// more than `maxListBytes`.
void buildVoxelGrid(const CellMesh& mesh, const CellLattice& cells, size_t maxListBytes, Progress& progress,
                    VoxelGrid& grid);

}  // namespace raymap::cpu
