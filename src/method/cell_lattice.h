#pragma once

#include <cstdint>
#include <vector>

#include "method/cell_lattice_shared.h"
#include "method/cell_mesh.h"

namespace raymap {

/// Lattice of cubic cells in sample units: cell c is the cube of side `size` centred at first + size * c. By
/// default there is one cell around every sample. The index runs fastest along x, as in `Grid`.
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

/// Returns lattices whose occupied cells together hold every triangle. The first has the samples' own cells.
/// If the mesh reaches beyond them, a second, coarser one covers both. It has at most as many cells, or 32768
/// if that is more (docs/dev/decisions/mesh_outside_the_box.md).
std::vector<CellLattice> coverMesh(const CellMesh& mesh);
/// Returns the same lattices for a mesh with these bounds, in cell units.
std::vector<CellLattice> coverBounds(const glm::vec3& meshLow, const glm::vec3& meshHigh,
                                     const glm::ivec3& dims);

/// Returns the value of an empty cell: finite, yet larger than any squared distance in the grid (§3.3).
inline float emptyCell(glm::ivec3 dims) {
  const glm::vec3 d(dims);
  return glm::dot(d, d) + 1.0f;
}

}  // namespace raymap
