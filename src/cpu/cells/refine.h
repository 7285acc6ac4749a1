#pragma once

#include "cpu/cells/cell_levels.h"

namespace raymap::cpu {

/// The end of §3.3: the distance, in sample units, of every sample to the triangles of its nearest occupied
/// cell and, with `reach` 1, of that cell's 26 neighbours too, over all levels; and the closest of those
/// triangles, the lowest of several.
void refineDistance(const CellMesh& mesh, std::span<const CellLevel> levels, int reach, Progress& progress,
                    Buffer<float>& distance, Buffer<uint32_t>* triangle);

}  // namespace raymap::cpu
