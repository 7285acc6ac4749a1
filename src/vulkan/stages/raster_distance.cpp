// Krayer & Müller 2019, §3.3, last paragraph.

#include "vulkan/stages/raster_distance.h"

#include <bit>

#include "method/cell_lattice.h"
#include "shaders/raster_distance_samples_spv.h"
#include "shaders/raster_distance_spv.h"

namespace raymap::vulkan {

RasterDistanceStage::RasterDistanceStage(Device& device, ScratchMemory* scratch)
    : runs_(device),
      kernel_(device, shaders::kRasterDistance, kRunsGroup),
      squared_(device, "cell distances", scratch) {}

void RasterDistanceStage::reserve(const CellLattice& cells, uint32_t triangles, const ListSizes& lists) {
  cells_ = cells;
  runs_.reserve(cells, triangles, lists.rows);
  kernel_.choose(isOfSamples(cells));
  squared_.resize<float>(cells.count());
}

void RasterDistanceStage::record(Commands& commands, const DeviceMesh& mesh) {
  runs_.record(commands, mesh);
  commands.fill(squared_, std::bit_cast<uint32_t>(emptyCell(cells_.dims)));
  const RasterDistancePush push{.vertices = mesh.vertices,
                                .triangles = mesh.triangles,
                                .runTriangles = runs_.triangles(),
                                .runCells = runs_.firstCells(),
                                .runStarts = runs_.starts(),
                                .totals = runs_.totals().address(),
                                .squared = squared_.address(),
                                .cells = latticeOf(cells_),
                                .perCell2 = static_cast<float>(1.0 / (cells_.size * cells_.size)),
                                .mostRows = runs_.mostRows()};
  runs_.dispatch(commands, *kernel_, push);
}

CellLevelData RasterDistanceStage::level(const DistanceTransformStage& transform) const {
  return {.squared = squared_.address(), .nearestCell = transform.nearestCell(), .cells = latticeOf(cells_)};
}

RasterDistanceSamplesStage::RasterDistanceSamplesStage(Device& device)
    : kernel_(device, shaders::kRasterDistanceSamples, 256), levels_(device) {}

void RasterDistanceSamplesStage::reserve(const glm::ivec3& dims, std::span<const CellLevelData> levels) {
  dims_ = dims;
  kernel_.choose(levels.size() == 1);
  levels_.reserve(levels);
}

void RasterDistanceSamplesStage::record(Commands& commands, VkDeviceAddress distance) {
  levels_.record(commands);
  commands.dispatch(*kernel_,
                    {.levels = levels_.address(),
                     .distance = distance,
                     .nx = dims_.x,
                     .ny = dims_.y,
                     .nz = dims_.z,
                     .levelCount = levels_.count()},
                    uint64_t{dims_.x} * dims_.y * dims_.z);
}

}  // namespace raymap::vulkan
