#pragma once

#include "cell_mesh.h"

namespace raymap {

/// Which triangles touch which cell (§3.1, Fig. 2): cell c holds `triangles[starts[c] .. starts[c + 1])`, in
/// ascending order, as count, exclusive prefix sum and fill left them.
struct VoxelGrid {
  Buffer<uint64_t> starts;
  Buffer<uint32_t> triangles;
};

void buildVoxelGrid(const CellMesh& mesh, VoxelGrid& grid);

}  // namespace raymap
