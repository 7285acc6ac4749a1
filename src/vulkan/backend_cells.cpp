// The paper's distances (§3.1, §3.3), over the lattices that cover the mesh.

#include "backend.h"

namespace raymap::vulkan {

CellRuns::Triangles Backend::cellTriangles() const {
  return {.vertices = mesh_.vertexBuffer().address(),
          .triangles = mesh_.triangleBuffer().address(),
          .count = mesh_.triangleCount()};
}

void Backend::coverMesh() {
  const Box box = bounds(*inputMesh_);
  const auto inCells = [&](const glm::dvec3& p) { return glm::vec3((p - grid_->origin) / grid_->spacing); };
  lattices_ = coverBounds(inCells(box.min), inCells(box.max), grid_->dims);
  while (levels_.size() < lattices_.size()) levels_.push_back(std::make_unique<Level>(*device_));
  for (size_t l = 0; l < lattices_.size(); ++l) levels_[l]->transform.reserve(lattices_[l].dims);
}

/// Runs a stage again with more room until all that it found has had some.
template <class Part>
void Backend::stageThatGrows(const char* name, Part Level::*part) {
  for (bool fits = false; !fits;) {
    commands_->stage(name, [&] {
      for (size_t l = 0; l < lattices_.size(); ++l) (*levels_[l].*part).record(*commands_, cellTriangles());
    });
    run();
    commands_ = commandBuffer_.begin();
    fits = true;
    for (size_t l = 0; l < lattices_.size(); ++l) {
      Part& grown = *levels_[l].*part;
      if (grown.fits()) continue;
      grown.grow();
      fits = false;
    }
  }
}

void Backend::voxelGrid() {
  coverMesh();
  for (size_t l = 0; l < lattices_.size(); ++l) {
    levels_[l]->grid.reserve(lattices_[l], mesh_.triangleCount());
    levels_[l]->distance.reserve(lattices_[l].count());
  }
  stageThatGrows("voxel_grid", &Level::grid);
}

void Backend::cellDistance() {
  stage("cell_distance", [&] {
    for (size_t l = 0; l < lattices_.size(); ++l)
      levels_[l]->distance.record(*commands_, cellTriangles(), levels_[l]->grid);
  });
}

void Backend::rasterDistance() {
  coverMesh();
  for (size_t l = 0; l < lattices_.size(); ++l)
    levels_[l]->raster.reserve(lattices_[l], mesh_.triangleCount());
  stageThatGrows("raster_distance", &Level::raster);
}

void Backend::distanceTransform() {
  const bool isRaster = options_->distance == DistanceMode::Raster;
  stage("distance_transform", [&] {
    for (size_t l = 0; l < lattices_.size(); ++l) {
      Level& level = *levels_[l];
      level.transform.record(
          *commands_, isRaster ? level.raster.squared().address() : level.distance.squared().address());
    }
  });
}

void Backend::refine() {
  const bool isRaster = options_->distance == DistanceMode::Raster;
  std::vector<CellLevelData> data;
  for (size_t l = 0; l < lattices_.size(); ++l) {
    const Level& level = *levels_[l];
    data.push_back(isRaster ? level.raster.level(level.transform)
                            : levelOf(level.grid, level.distance, level.transform));
  }
  if (isRaster)
    rasterSamples_.reserve(grid_->dims, data);
  else
    refine_.reserve(grid_->dims, data);
  stage("refine", [&] {
    if (isRaster) {
      rasterSamples_.record(*commands_, distance_.device.address());
      return;
    }
    const int reach = options_->distance == DistanceMode::Neighbours ? 1 : 0;
    refine_.record(*commands_, cellTriangles(),
                   {.distance = distance_.device.address(),
                    .triangle = addressOf(triangle_),
                    .scratch = levels_[0]->transform.scratch()},
                   reach);
  });
}

}  // namespace raymap::vulkan
