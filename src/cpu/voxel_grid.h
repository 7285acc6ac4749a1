#pragma once

#include "cell_mesh.h"
#include "progress.h"

#include <vector>

namespace raymap {

/// A lattice of cubic cells in sample units: cell c is the cube of side `size` centred at first + size * c.
/// By default one cell around every sample; x is fastest, as in `Grid`.
struct CellLattice {
  glm::ivec3 dims{0};
  glm::dvec3 first{0.0};
  double size = 1.0;  ///< A power of two, so that scaling by it is exact.

  size_t count() const { return size_t(dims.x) * size_t(dims.y) * size_t(dims.z); }
  glm::dvec3 centre(const glm::ivec3& c) const { return first + size * glm::dvec3(c); }
  size_t index(const glm::ivec3& c) const { return (size_t(c.z) * dims.y + c.y) * dims.x + c.x; }
  glm::ivec3 cell(size_t index) const {
    const size_t row = index / dims.x;
    return {int(index % dims.x), int(row % dims.y), int(row / dims.y)};
  }
};

/// The lattices whose occupied cells together hold every triangle: the samples' own cells and, where the mesh
/// reaches beyond them, a coarser one of at most about as many cells that covers both
/// (docs/decisions/mesh_outside_the_box.md).
std::vector<CellLattice> coverMesh(const CellMesh& mesh);
/// The same for a mesh with these bounds, in cell units.
std::vector<CellLattice> coverBounds(const glm::vec3& meshLow, const glm::vec3& meshHigh,
                                     const glm::ivec3& dims);

/// Which triangles touch which cell (§3.1, Fig. 2): cell c holds `triangles[starts[c] .. starts[c + 1])`, in
/// ascending order, as count, exclusive prefix sum and fill left them.
struct VoxelGrid {
  CellLattice cells;
  Buffer<uint64_t> starts;
  Buffer<uint32_t> triangles;

  std::span<const uint32_t> list(size_t cell) const {
    return {triangles.data() + starts[cell], triangles.data() + starts[cell + 1]};
  }
};

/// Lists more than `maxListBytes` long are `Error(Memory)`.
void buildVoxelGrid(const CellMesh& mesh, const CellLattice& cells, size_t maxListBytes, Progress& progress,
                    VoxelGrid& grid);

}  // namespace raymap
