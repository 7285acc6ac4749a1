#pragma once

#include "voxel_grid.h"

namespace raymap {

/// The value of an empty cell: larger than any squared distance in the grid, yet no infinity (§3.3).
inline float emptyCell(glm::ivec3 dims) {
  const glm::vec3 d(dims);
  return glm::dot(d, d) + 1.0f;
}

/// The squared distance, in units of the lattice's cells, from each occupied cell's centre to the triangles
/// in it; `emptyCell` in all others.
void computeCellDistance(const CellMesh& mesh, const VoxelGrid& grid, Progress& progress,
                         Buffer<float>& squared);

}  // namespace raymap
