// Cells of a lattice. GPU twin of CellLattice in method/cell_lattice.h.

#include "method/cell_lattice_shared.h"
#include "vulkan/primitives/soft_double.glsl"
#include "vulkan/stages/cell_lattice_push.h"

// Whether the host knows isOfSamples of all the kernel's lattices. Such a kernel has no doubles in software: some devices
// spend time on branches that no invocation takes.
layout(constant_id = 1) const bool kIsOfSamples = false;

Double firstCentre(Lattice cells, uint axis) {
  return axis == 0 ? cells.firstX : axis == 1 ? cells.firstY : cells.firstZ;
}

// Returns whether each cell (i, j, k) is the one around sample (i, j, k).
bool isOfSamples(Lattice cells) {
  return kIsOfSamples || ((cells.firstX | cells.firstY | cells.firstZ) == 0 && cells.size == 1.0);
}

// Returns the exponent of the cells' size, which is a power of two.
int sizeExponent(Lattice cells) {
  return int(floatBitsToUint(cells.size) >> 23) - 127;
}

vec3 cellCentre(Lattice cells, uvec3 c) {
  if (isOfSamples(cells)) return vec3(c);
  const int exponent = sizeExponent(cells);
  vec3 centre;
  [[dont_unroll]] for (uint axis = 0; axis < 3; ++axis) {
    centre = vec3(centre.yz, floatOf(sum(firstCentre(cells, axis), timesPowerOfTwo(doubleOf(int(c.x)), exponent))));
    c = c.yzx;
  }
  return centre;
}

// Returns a coordinate in cells instead of samples.
Double inCells(Lattice cells, uint axis, Double coordinate) {
  return timesPowerOfTwo(difference(coordinate, firstCentre(cells, axis)), -sizeExponent(cells));
}
