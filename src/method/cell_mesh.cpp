#include "method/cell_mesh.h"

#include "base/parallel.h"

namespace raymap {

void toCellUnits(const PackedMesh& mesh, const Grid& grid, CellMesh& cells) {
  constexpr size_t kGrain = size_t{1} << 16;
  cells.dims = grid.dims;
  cells.triangles = mesh.triangles;
  cells.vertices.resizeUninitialized(mesh.vertices.size());
  const glm::dvec3 shift = mesh.origin - grid.origin;
  const double scale = 1.0 / grid.spacing;  // Every device must multiply by it to get the same bits.
  parallelFor(mesh.vertices.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v)
      cells.vertices[v] = glm::vec3((shift + glm::dvec3(mesh.vertices[v])) * scale);
  });
}

}  // namespace raymap
