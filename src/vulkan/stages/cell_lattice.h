#pragma once

#include <bit>

#include "method/cell_lattice.h"
#include "vulkan/stages/cell_lattice_push.h"

namespace raymap::vulkan {

/// Returns the lattice in the shaders' layout.
inline Lattice latticeOf(const CellLattice& cells) {
  return {.firstX = std::bit_cast<uint64_t>(cells.first.x),
          .firstY = std::bit_cast<uint64_t>(cells.first.y),
          .firstZ = std::bit_cast<uint64_t>(cells.first.z),
          .size = static_cast<float>(cells.size),
          .dims = glm::uvec3(cells.dims)};
}

/// Returns whether each cell (i, j, k) is the one around sample (i, j, k).
inline bool isOfSamples(const CellLattice& cells) {
  return cells.first == glm::dvec3(0.0) && cells.size == 1.0;
}

}  // namespace raymap::vulkan
