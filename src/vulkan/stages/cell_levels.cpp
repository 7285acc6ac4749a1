#include "vulkan/stages/cell_levels.h"

#include <algorithm>
#include <stdexcept>

namespace raymap::vulkan {

CellLevelData levelOf(const VoxelGridStage& grid, const CellDistanceStage& distance,
                      const DistanceTransformStage& transform) {
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
  upload_.resize<CellLevelData>(levels.size());
  levels_.resize<CellLevelData>(levels.size());
  std::ranges::copy(levels, upload_.mapped<CellLevelData>().begin());
}

void CellLevels::record(Commands& commands) const {
  commands.copy(upload_, levels_, levels_.bytes());
}

}  // namespace raymap::vulkan
