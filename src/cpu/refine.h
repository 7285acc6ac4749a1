#pragma once

#include "progress.h"
#include "voxel_grid.h"

namespace raymap {

/// The end of §3.3: the distance, in cell units, of every sample to the triangles of its nearest occupied
/// cell and, with `reach` 1, of that cell's 26 neighbours too; and the closest of those triangles.
void refineDistance(const CellMesh& mesh, const VoxelGrid& grid, const Buffer<uint32_t>& nearestCell,
                    int reach, Progress& progress, Buffer<float>& distance, Buffer<uint32_t>& triangle);

}  // namespace raymap
