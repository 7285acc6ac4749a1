// Cells of a lattice. GPU twin of CellLattice in method/cell_lattice.h.

#include "vulkan/stages/cell_lattice_push.h"

const uint kNoCell = 0xffffffffu;

uint cellIndex(Lattice cells, uvec3 c) {
  return (c.z * cells.ny + c.y) * cells.nx + c.x;
}

uvec3 cellAt(Lattice cells, uint index) {
  const uint row = index / cells.nx;
  return uvec3(index % cells.nx, row % cells.ny, row / cells.ny);
}

dvec3 firstCentre(Lattice cells) {
  return dvec3(cells.firstX, cells.firstY, cells.firstZ);
}

vec3 cellCentre(Lattice cells, uvec3 c) {
  return vec3(firstCentre(cells) + cells.size * dvec3(c));
}
