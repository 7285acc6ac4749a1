// The paper's distances (§3.1, §3.3), over the lattices that cover the mesh.

#include "vulkan/runtime/stage_recorder.h"

namespace raymap::vulkan {

void StageRecorder::reserveCells() {
  const std::vector<CellLattice>& lattices = extent_.lattices;
  while (levels_.size() < lattices.size())
    levels_.push_back(std::make_unique<CellStages>(*device_, &scratch_));
  std::vector<CellLevelData> data;
  for (size_t l = 0; l < lattices.size(); ++l) {
    levels_[l]->reserve(lattices[l], extent_.triangles, extent_.lists[l], !isRaster());
    data.push_back(levels_[l]->data());
  }
  if (isRaster())
    rasterDistance_.reserve(extent_.dims, data);
  else
    refine_.reserve(extent_.dims, extent_.triangles, data);
}

bool StageRecorder::fits(const Findings& findings) const {
  if (isExact()) return true;
  for (size_t l = 0; l < extent_.lattices.size(); ++l)
    if (!levels_[l]->grid.fits(sizesOf(findings.lists[l]))) return false;
  return true;
}

void StageRecorder::grow(const Findings& findings) {
  Extent larger = extent_;
  for (size_t l = 0; l < larger.lattices.size(); ++l) larger.lists[l] = sizesOf(findings.lists[l]);
  reserve(larger);
}

void StageRecorder::voxelGrid() {
  recordWithRays([&] {
    for (size_t l = 0; l < extent_.lattices.size(); ++l) levels_[l]->grid.record(*commands_, mesh_.mesh());
  });
}

void StageRecorder::cellDistance() {
  for (size_t l = 0; l < extent_.lattices.size(); ++l)
    levels_[l]->distance.record(*commands_, mesh_.mesh(), levels_[l]->grid);
}

void StageRecorder::rasterDistance() {
  voxelGrid();
  cellDistance();
}

void StageRecorder::distanceTransform() {
  for (size_t l = 0; l < extent_.lattices.size(); ++l)
    levels_[l]->transform.record(*commands_, levels_[l]->distance.squared().address());
}

void StageRecorder::refine() {
  if (isRaster()) {
    rasterDistance_.record(*commands_, results_.distance);
    return;
  }
  const int reach = options_->distance == DistanceMode::Neighbours ? 1 : 0;
  refine_.record(*commands_, mesh_.mesh(),
                 {.distance = results_.distance,
                  .triangle = results_.triangle,
                  .scratch = levels_[0]->transform.scratch()},
                 reach);
}

}  // namespace raymap::vulkan
