#include "backend.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cell_distance.h"
#include "distance_transform.h"
#include "exact_distance.h"
#include "memory.h"
#include "orientation.h"
#include "parallel.h"
#include "raster_distance.h"
#include "refine.h"
#include "sign.h"

namespace raymap {

namespace {

constexpr size_t kGrain = size_t{1} << 16;
constexpr size_t kTreeBytesPerTriangle = 108;

}  // namespace

size_t CpuBackend::bytesNeeded(const Mesh& mesh, const Grid& grid, const Options& options) {
  const bool exact = options.distance == DistanceMode::Exact;
  const bool raster = options.distance == DistanceMode::Raster;
  size_t perSample = sizeof(float);
  if (options.triangleIds || (!exact && !raster)) perSample += sizeof(uint32_t);
  if (!exact) perSample += sizeof(float) + sizeof(uint32_t) + (raster ? 0 : sizeof(uint64_t));
  if (options.sign != SignMode::None) perSample += sizeof(float);
  if (options.sign == SignMode::Harmonic) perSample += 14;
  if (options.sign == SignMode::Evolution) perSample += sizeof(float);
  if (options.confidence) perSample += sizeof(float);
  const bool needsTree = exact || options.sign == SignMode::Harmonic || options.closeHoles;
  // While patches are found: three half edges a face, the patches, the turns; a key and a place a vertex.
  constexpr size_t kTurningTriangle = 80, kTurningVertex = 20;
  const bool mayTurn = mayTurnFaces(options, 1.0);
  const size_t perTriangle = (exact ? 0 : 32) + (needsTree ? kTreeBytesPerTriangle : 0) +
                             (options.closeHoles ? kRimBytesPerTriangle : 0) +
                             (mayTurn ? kTurningTriangle : 0);
  return grid.sampleCount() * perSample + mesh.triangles.size() * perTriangle +
         mesh.vertices.size() * (sizeof(glm::vec3) + (mayTurn ? kTurningVertex : 0));
}

void CpuBackend::begin(const Mesh& mesh, const Grid& grid, const Options& options, Progress& progress,
                       Field& field) {
  inputMesh_ = &mesh;
  options_ = &options;
  progress_ = &progress;
  field_ = &field;
  memoryLimit_ = options.memoryLimit ? options.memoryLimit : availableMemory();
  toCellUnits(mesh, grid, mesh_);
  hasSurfaceTree_ = false;
  const size_t count = grid.sampleCount();
  field.grid = grid;
  field.band = options.band * grid.spacing;
  field.distance.resize(count);
  field.triangle.resize(options.triangleIds ? count : 0);
  field.winding.resize(options.winding && options.sign != SignMode::None ? count : 0);
  field.confidence.resize(options.confidence && options.sign != SignMode::None ? count : 0);
  windingSummary_ = {};
  patch_.clear();
  doubtfulShare_ = 0.0;
  faceSides_ = {};
}

const SurfaceTree& CpuBackend::surfaceTree() {
  if (!std::exchange(hasSurfaceTree_, true)) surfaceTree_.build(mesh_);
  return surfaceTree_;
}

void CpuBackend::exactDistance() {
  computeExactDistance(surfaceTree(), mesh_.dims, options_->band, *progress_, field_->distance,
                       options_->triangleIds ? &field_->triangle : nullptr);
}

void CpuBackend::voxelGrid() {
  const std::vector<CellLattice> lattices = coverMesh(mesh_);
  levels_.resize(lattices.size());
  const size_t held = bytes();
  for (size_t l = 0; l < lattices.size(); ++l)
    buildVoxelGrid(mesh_, lattices[l], memoryLimit_ > held ? memoryLimit_ - held : 0, *progress_,
                   levels_[l].grid);
}

void CpuBackend::cellDistance() {
  for (CellLevel& level : levels_) computeCellDistance(mesh_, level.grid, *progress_, level.squared);
}

void CpuBackend::rasterDistance() {
  const std::vector<CellLattice> lattices = coverMesh(mesh_);
  levels_.resize(lattices.size());
  for (size_t l = 0; l < lattices.size(); ++l) {
    levels_[l].grid.cells = lattices[l];
    rasterizeDistance(mesh_, lattices[l], *progress_, levels_[l].squared);
  }
}

void CpuBackend::distanceTransform() {
  for (CellLevel& level : levels_)
    transformDistance(level.grid.cells.dims, *progress_, level.squared, level.nearestCell);
}

void CpuBackend::refine() {
  if (options_->distance == DistanceMode::Raster) {
    sampleRasterDistance(mesh_.dims, levels_, *progress_, field_->distance);
    return;
  }
  const int reach = options_->distance == DistanceMode::Neighbours ? 1 : 0;
  refineDistance(mesh_, levels_, reach, *progress_, field_->distance,
                 options_->triangleIds ? &field_->triangle : nullptr);
}

void CpuBackend::crossings() {
  countCrossings(mesh_, *progress_, crossings_);
}

void CpuBackend::rayMap() {
  buildRayMap(mesh_.dims, crossings_, rayMap_);
}

void CpuBackend::winding() {
  windingSummary_ = windingSolver_.compute(rayMap_, *options_, *progress_, windingBuffer());
}

void CpuBackend::orientation() {
  const bool isHarmonic = options_->sign == SignMode::Harmonic;
  doubtfulShare_ = windingSummary_.doubtfulShare;
  if (!mayTurnFaces(*options_, doubtfulShare_)) return;
  FaceTurner turner(
      {mesh_, turnedTriangles_, crossings_, rayMap_, windingSolver_, windingSummary_, windingBuffer()},
      *options_, *progress_);
  const double misfit = isHarmonic ? turner.misfit() : turner.solve(Turns(mesh_.triangles.size(), 0));
  if (!shouldLookAtFaces(*options_, misfit,
                         contradictsParity(rayMap_, windingBuffer(), options_->threshold))) {
    faceSides_ = {.turns = {}, .misfitGiven = misfit, .misfit = misfit};
    return;
  }
  faceSides_ = chooseSides(*inputMesh_, misfit, options_->orientation, turner, *progress_);
  if (!isHarmonic) winding();
  if (hasSurfaceTree_) surfaceTree_.turn(faceSides_.turns);
}

void CpuBackend::windingDipoles() {
  if (options_->sign != SignMode::Harmonic || windingSummary_.doubtfulShare == 0.0) return;
  windingDipoles_.settle([this]() -> const SurfaceTree& { return surfaceTree(); }, mesh_.dims,
                         field_->distance, options_->threshold, *progress_, windingBuffer());
}

void CpuBackend::closeHoles() {
  // Where the six rays agree, triangles account for every change of the winding number.
  if (windingSummary_.doubtfulShare == 0.0) return;
  const std::vector<MissingEdge> edges =
      findMissingEdges(rayMap_, windingBuffer(), options_->threshold, *progress_);
  if (edges.empty()) return;
  const size_t held = bytes();
  requirePatch(edges.size(), kTreeBytesPerTriangle, memoryLimit_ > held ? memoryLimit_ - held : 0);
  const auto windingAt = [this](std::span<const glm::vec3> points) {
    return windingDipoles_.numbersAt([this]() -> const SurfaceTree& { return surfaceTree(); }, points,
                                     *progress_);
  };
  makePatch(mesh_, edges, options_->threshold, windingAt, *progress_, patch_);
  patchTree_.build(patch_.mesh);
  addExactDistance(patchTree_, mesh_.dims, *progress_, field_->distance,
                   options_->triangleIds ? &field_->triangle : nullptr);
}

void CpuBackend::sign() {
  applySign(windingBuffer(), options_->threshold, options_->invert, field_->distance);
  if (options_->confidence)
    computeConfidence(rayMap_, windingBuffer(), options_->threshold, field_->confidence);
}

void CpuBackend::finish() {
  const auto scale = static_cast<float>(field_->grid.spacing);
  const auto band = options_->band > 0.0 ? static_cast<float>(options_->band) : INFINITY;
  parallelFor(field_->distance.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      float& d = field_->distance[i];
      d = std::max(-band, std::min(d, band)) * scale;
    }
  });
}

size_t CpuBackend::bytes() const {
  size_t total = mesh_.vertices.capacityBytes() + turnedTriangles_.capacityBytes() + surfaceTree_.bytes() +
                 windingSolver_.bytes() + windingDipoles_.bytes() + winding_.capacityBytes() +
                 patch_.bytes() + patchTree_.bytes();
  for (const CellLevel& level : levels_)
    total += level.grid.starts.capacityBytes() + level.grid.triangles.capacityBytes() +
             level.squared.capacityBytes() + level.nearestCell.capacityBytes();
  for (const AxisCrossings& axis : crossings_)
    total += axis.starts.capacityBytes() + axis.entries.capacityBytes();
  for (const RayMap::Axis& axis : rayMap_.axes)
    total += axis.starts.capacityBytes() + axis.steps.capacityBytes();
  return total;
}

}  // namespace raymap
