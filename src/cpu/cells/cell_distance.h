#pragma once

#include "cpu/cells/voxel_grid.h"

namespace raymap::cpu {

/// Computes the squared distance from each occupied cell's centre to the triangles in it, in units of the
/// lattice's cells. All other cells get `emptyCell`.
void computeCellDistance(const CellMesh& mesh, const VoxelGrid& grid, Progress& progress,
                         Buffer<float>& squared);

}  // namespace raymap::cpu
