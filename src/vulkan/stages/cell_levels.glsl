// Places of samples in the lattices of coverMesh. GPU twin of cpu/cells/cell_levels.h.

#include "vulkan/stages/cell_lattice.glsl"
#include "vulkan/stages/cell_levels_push.h"

layout(buffer_reference, scalar, buffer_reference_align = 8) buffer CellLevels { CellLevelData at[]; };

struct CellPoint {
  vec3 at;  // In cells.
  uvec3 cell;  // The lattice's cell nearest to the point.
};

CellPoint cellPointOf(Lattice cells, uvec3 position) {
  precise const dvec3 at = (dvec3(position) - firstCentre(cells)) / cells.size;
  const ivec3 cell = clamp(ivec3(floor(vec3(at) + 0.5)), ivec3(0), ivec3(cells.nx, cells.ny, cells.nz) - 1);
  return CellPoint(vec3(at), uvec3(cell));
}
