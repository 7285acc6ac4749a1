#pragma once

#include "cell_mesh.h"

namespace raymap {

/// The last paragraph of §3.3: each triangle writes its squared distance into the cells it touches, keeping
/// the minimum; empty cells as in `computeCellDistance`. No lists are built.
void rasterizeDistance(const CellMesh& mesh, Buffer<float>& squared);

}  // namespace raymap
