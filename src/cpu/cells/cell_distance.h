#pragma once

#include "cpu/cells/voxel_grid.h"

namespace raymap::cpu {

/// The squared distance, in units of the lattice's cells, from each occupied cell's centre to the triangles
/// in it; `emptyCell` in all others.
void computeCellDistance(const CellMesh& mesh, const VoxelGrid& grid, Progress& progress,
                         Buffer<float>& squared);

}  // namespace raymap::cpu
