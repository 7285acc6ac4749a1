#ifndef RAYMAP_SHARED_CELL_LATTICE_H  // No pragma: GLSL also includes this more than once.
#define RAYMAP_SHARED_CELL_LATTICE_H

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

// See CellLattice in method/cell_lattice.h.
struct Lattice {
  uint64_t firstX, firstY, firstZ;  // Bits of doubles.
  float size;
  uvec3 dims;
};
RAYMAP_CHECK_SIZE(Lattice, 40);

RAYMAP_SHARED_END

#endif
