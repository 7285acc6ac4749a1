// Places of samples in the lattices of coverMesh. GPU twin of cpu/cells/cell_levels.h.

#include "vulkan/stages/cell_lattice.glsl"
#include "vulkan/stages/cell_levels_push.h"

layout(buffer_reference, scalar, buffer_reference_align = 8) buffer CellLevels { CellLevelData at[]; };

struct CellPoint {
  vec3 at;  // In cells.
  uvec3 cell;  // The lattice's cell nearest to the point.
};

CellPoint cellPointOf(Lattice cells, uvec3 position) {
  if (isOfSamples(cells)) return CellPoint(vec3(position), position);
  vec3 at;
  [[dont_unroll]] for (uint axis = 0; axis < 3; ++axis) {
    at = vec3(at.yz, floatOf(inCells(cells, axis, doubleOf(int(position.x)))));
    position = position.yzx;
  }
  const ivec3 cell = clamp(ivec3(floor(at + 0.5)), ivec3(0), ivec3(cells.dims) - 1);
  return CellPoint(at, uvec3(cell));
}
