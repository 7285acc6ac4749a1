#pragma once

#include "cpu/cells/cell_levels.h"

namespace raymap::cpu {

/// Writes each triangle's squared distance, in units of the lattice's cells, to the cells that it touches
/// (last paragraph of §3.3). A cell keeps the minimum; all others get `emptyCell`. No lists are built.
void rasterizeDistance(const CellMesh& mesh, const CellLattice& cells, Progress& progress,
                       Buffer<float>& squared);

/// Computes the distance of every sample, in sample units, after the distance transform of each level.
void sampleRasterDistance(glm::ivec3 dims, std::span<const CellLevel> levels, Progress& progress,
                          Buffer<float>& distance);

}  // namespace raymap::cpu
