#pragma once

#include "voxel_grid.h"

namespace raymap {

/// The squared distance, in cell units, from each occupied cell's centre to the triangles in it; an empty
/// cell gets a value larger than any squared distance in the grid (§3.3).
void computeCellDistance(const CellMesh& mesh, const VoxelGrid& grid, Buffer<float>& squared);

}  // namespace raymap
