#pragma once

#include <raymap/buffer.h>
#include <raymap/grid.h>

#include <vector>

#include "mesh/packed_mesh.h"
#include "mesh/rim_edges.h"

namespace raymap::cpu {

/// Returns one byte per sample of a grid: 1 wherever a rim is less than half a cell away from the cube
/// between the sample and the next ones, 0 two cells away and farther. Returns nothing if there are no rims.
Buffer<uint8_t> markRims(const PackedMesh& mesh, const std::vector<RimEdge>& rims, const Grid& grid);

}  // namespace raymap::cpu
