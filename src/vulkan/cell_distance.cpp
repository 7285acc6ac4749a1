// Krayer & Müller 2019, §3.3.
//
// Paper: an invocation for each cell. Here: one for each pair of cell and triangle, with an atomic minimum,
// because cells may hold none or all triangles.

#include "cell_distance.h"

#include <bit>

#include "cpu/cell_distance.h"
#include "shaders/cell_distance_spv.h"

namespace raymap::vulkan {

CellDistance::CellDistance(Device& device, ScratchMemory* scratch)
    : kernel_(device, shaders::kCellDistance, kRunsGroup), squared_(device, "cell distances", scratch) {}

void CellDistance::reserve(size_t cells) {
  squared_.resize<float>(cells);
}

void CellDistance::record(Commands& commands, const DeviceMesh& mesh, const VoxelGrid& grid) {
  const CellLattice& cells = grid.lattice();
  commands.fill(squared_, std::bit_cast<uint32_t>(emptyCell(cells.dims)));
  grid.dispatch(commands, kernel_,
                {.vertices = mesh.vertices,
                 .triangles = mesh.triangles,
                 .entryCells = grid.cells().address(),
                 .entryTriangles = grid.triangles().address(),
                 .count = grid.entryCount().address,
                 .squared = squared_.address(),
                 .cells = latticeOf(cells),
                 .perCell2 = static_cast<float>(1.0 / (cells.size * cells.size))});
}

}  // namespace raymap::vulkan
