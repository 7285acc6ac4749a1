#pragma once

#include <raymap/buffer.h>

#include "method/cell_mesh.h"

namespace raymap::cpu {

/// Finds the rims of a surface: the edges at which it does not end evenly. Every other edge is passed as
/// often in one direction as in the other. Positions are the same if their coordinates are exactly equal.
/// Returns one byte per sample of the lattice: 1 wherever a rim is less than half a cell away from the cube
/// between the sample and the next ones, 0 two cells away and farther. Returns nothing if there are no rims;
/// then all winding numbers are whole.
Buffer<uint8_t> markRims(const CellMesh& mesh);

}  // namespace raymap::cpu
