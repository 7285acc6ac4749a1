// Krayer & Müller 2019, §3.3.
//
// Paper: one invocation per cell. Here: one per pair of cell and triangle, with an atomic minimum, because a
// cell may hold anything from none to all of the triangles.

#include "vulkan/stages/cell_distance.h"

#include <bit>

#include "method/cell_lattice.h"
#include "shaders/cell_distance_spv.h"

namespace raymap::vulkan {

CellDistanceStage::CellDistanceStage(Device& device, ScratchMemory* scratch)
    : kernel_(device, shaders::kCellDistance, kGroup), squared_(device, "cell distances", scratch) {}

void CellDistanceStage::reserve(const CellLattice& cells) {
  kernel_.choose(isOfSamples(cells));
  squared_.resize<float>(cells.count());
}

void CellDistanceStage::record(Commands& commands, const DeviceMesh& mesh, const VoxelGridStage& grid) {
  const CellLattice& cells = grid.lattice();
  commands.fill(squared_, std::bit_cast<uint32_t>(emptyCell(cells.dims)));
  grid.dispatch(commands, *kernel_,
                {.vertices = mesh.vertices,
                 .triangles = mesh.triangles,
                 .entryCells = grid.cells().address(),
                 .entryTriangles = grid.triangles().address(),
                 .count = grid.entryCount(),
                 .squared = squared_.address(),
                 .cells = latticeOf(cells),
                 .perCell2 = static_cast<float>(1.0 / (cells.size * cells.size)),
                 .mostEntries = grid.mostEntries()});
}

}  // namespace raymap::vulkan
