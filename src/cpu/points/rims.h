#pragma once

#include <raymap/grid.h>

#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap::cpu {

/// An edge that the faces of a mesh pass `times` times more often from vertex `from` to vertex `to` than
/// back.
struct RimEdge {
  uint32_t from, to;
  uint32_t times;
};

/// Finds the rims of a surface: the edges at which it does not end evenly. Every other edge is passed as
/// often in one direction as in the other. Positions are the same if their coordinates are exactly equal. The
/// grid's cells decide the speed only.
std::vector<RimEdge> findRims(const PackedMesh& mesh, const Grid& grid);

/// Returns one byte per sample of a grid: 1 wherever a rim is less than half a cell away from the cube
/// between the sample and the next ones, 0 two cells away and farther. Returns nothing if there are no rims.
Buffer<uint8_t> markRims(const PackedMesh& mesh, const std::vector<RimEdge>& rims, const Grid& grid);

}  // namespace raymap::cpu
