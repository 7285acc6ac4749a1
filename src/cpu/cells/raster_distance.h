#pragma once

#include "cpu/cells/cell_levels.h"

namespace raymap::cpu {

/// The last paragraph of §3.3: each triangle writes its squared distance, in units of the lattice's cells,
/// into the cells it touches, keeping the minimum; `emptyCell` in all others. No lists are built.
void rasterizeDistance(const CellMesh& mesh, const CellLattice& cells, Progress& progress,
                       Buffer<float>& squared);

/// The distance, in sample units, of every sample after the distance transform of each level.
void sampleRasterDistance(glm::ivec3 dims, std::span<const CellLevel> levels, Progress& progress,
                          Buffer<float>& distance);

}  // namespace raymap::cpu
