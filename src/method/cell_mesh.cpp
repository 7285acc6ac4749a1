#include "method/cell_mesh.h"

#include "base/parallel.h"

namespace raymap {

void toCellUnits(const PackedMesh& mesh, const Grid& grid, CellMesh& cells) {
  constexpr size_t kGrain = size_t{1} << 16;
  cells.dims = grid.dims;
  cells.triangles = mesh.triangles;
  cells.vertices.resizeUninitialized(mesh.vertices.size());
  cells.given = mesh;
  // Every device must multiply by the scale to get the same bits.
  cells.units = {.shift = mesh.origin - grid.origin, .scale = 1.0 / grid.spacing};
  parallelFor(mesh.vertices.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) cells.vertices[v] = cells.units(mesh.vertices[v]);
  });
}

}  // namespace raymap
