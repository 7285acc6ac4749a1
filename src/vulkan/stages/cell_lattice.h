#pragma once

#include "method/cell_lattice.h"
#include "vulkan/stages/cell_lattice_push.h"

namespace raymap::vulkan {

/// Returns the lattice in the shaders' layout.
inline Lattice latticeOf(const CellLattice& cells) {
  return {.firstX = cells.first.x,
          .firstY = cells.first.y,
          .firstZ = cells.first.z,
          .size = cells.size,
          .nx = static_cast<uint32_t>(cells.dims.x),
          .ny = static_cast<uint32_t>(cells.dims.y),
          .nz = static_cast<uint32_t>(cells.dims.z)};
}

}  // namespace raymap::vulkan
