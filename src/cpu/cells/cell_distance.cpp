// Krayer & Müller 2019, §3.3.

#include "cpu/cells/cell_distance.h"

#include <algorithm>

#include "base/parallel.h"
#include "cpu/cells/triangle.h"

namespace raymap::cpu {

void computeCellDistance(const CellMesh& mesh, const VoxelGrid& grid, Progress& progress,
                         Buffer<float>& squared) {
  constexpr size_t kGrain = 4096;
  const CellLattice& cells = grid.cells;
  const float empty = emptyCell(cells.dims);
  const auto perCell2 = static_cast<float>(1.0 / (cells.size * cells.size));
  squared.resizeUninitialized(cells.count());
  parallelFor(cells.count(), kGrain, [&](size_t begin, size_t end) {
    progress.report(double(begin) / double(cells.count()));
    for (size_t c = begin; c < end; ++c) {
      squared[c] = empty;
      if (grid.starts[c] == grid.starts[c + 1]) continue;
      const glm::vec3 centre(cells.centre(cells.cell(c)));
      for (const uint32_t t : grid.list(c))
        squared[c] =
            std::min(squared[c], perCell2 * triangleSquaredDistance(centre, mesh.corner(t, 0),
                                                                    mesh.corner(t, 1), mesh.corner(t, 2)));
    }
  });
}

}  // namespace raymap::cpu
