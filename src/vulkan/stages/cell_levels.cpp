#include "vulkan/stages/cell_levels.h"

#include <stdexcept>

namespace raymap::vulkan {

void CellStages::reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists,
                         bool hasLists) {
  transform.reserve(cells.dims);
  grid.reserve(cells, triangles, lists, hasLists);
  distance.reserve(cells);
}

CellLevelData CellStages::data() const {
  return {.begins = grid.begins().bytes() > 0 ? grid.begins().address() : 0,
          .entryCells = grid.cells().address(),
          .entryTriangles = grid.triangles().address(),
          .count = grid.entryCount(),
          .squared = distance.squared().address(),
          .nearestCell = transform.nearestCell(),
          .cells = latticeOf(grid.lattice())};
}

CellLevels::CellLevels(Device& device)
    : upload_(device, "cell levels upload", MemoryUse::Upload), levels_(device, "cell levels") {}

void CellLevels::reserve(std::span<const CellLevelData> levels) {
  if (levels.empty() || levels.size() > kMostLevels)
    throw std::logic_error("no levels of cells, or too many");
  upload_.fill(levels);
  levels_.resize<CellLevelData>(levels.size());
}

void CellLevels::record(Commands& commands) const {
  commands.copy(upload_, levels_, levels_.bytes());
}

}  // namespace raymap::vulkan
