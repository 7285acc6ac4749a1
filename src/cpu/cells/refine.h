#pragma once

#include "cpu/cells/cell_levels.h"

namespace raymap::cpu {

/// Computes the distance of every sample, in sample units, to the triangles of its nearest occupied cell (end
/// of §3.3). With `reach` 1, those of the cell's 26 neighbours are used too. The closest triangle of all
/// levels wins; of several, the lowest. `triangle` gets its index and may be null.
void refineDistance(const CellMesh& mesh, std::span<const CellLevel> levels, int reach, Progress& progress,
                    Buffer<float>& distance, Buffer<uint32_t>* triangle);

}  // namespace raymap::cpu
