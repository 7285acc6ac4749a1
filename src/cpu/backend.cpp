#include "cpu/backend.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/memory.h"
#include "base/parallel.h"
#include "cpu/cells/cell_distance.h"
#include "cpu/cells/distance_transform.h"
#include "cpu/cells/raster_distance.h"
#include "cpu/cells/refine.h"
#include "cpu/distance/exact_distance.h"
#include "cpu/distance/finish.h"
#include "cpu/sign/close_holes.h"
#include "cpu/sign/crossings_lines.h"
#include "cpu/sign/orientation.h"
#include "cpu/sign/sign.h"
#include "cpu/sign/winding_doubts.h"
#include "cpu/sign/winding_rims_samples.h"
#include "method/orientation_surface.h"
#include "method/stage_times.h"
#include "method/winding_dipoles_shared.h"

namespace raymap::cpu {

namespace {

constexpr size_t kFacesPerTask = 1024;

}  // namespace

void Backend::setJob(const Job& job, std::optional<Frames> frames) {
  // Few samples read few leaves, and most of those once.
  constexpr size_t kFewSamples = 4;  // Per triangle, the share of one.
  const bool areFew = kFewSamples * job.grid.sampleCount() < job.mesh.triangles.size();
  job_.emplace(job);
  frames_ = frames.value_or(areFew ? Frames::Made : Frames::Stored);
}

Stats Backend::run(const Job& job, std::optional<Frames> frames) {
  setJob(job, frames);
  checkFieldMemory(mesh().bytes() + bytesNeeded(), mostBytes());
  withThreads(job.machine.threads, [&] { runPipeline(*this); });
  Stats stats;
  stats.device = "cpu";
  addStages(job.progress, stats);
  stats.bytes = bytes();
  describeMesh(*this, job.grid, stats);
  return stats;
}

size_t Backend::bytesNeeded() const {
  const auto& [mesh, grid, options, progress, field, machine] = *job_;
  const bool isExact = options.distance == DistanceMode::Exact,
             isRaster = options.distance == DistanceMode::Raster, isSigned = options.sign != SignMode::None;
  const size_t samples = grid.sampleCount(), triangles = mesh.triangles.size(),
               numbers = size_t{1} + (options.triangle ? 1 : 0) + (isSigned ? 1 : 0) +
                         (isSigned && options.confidence ? 1 : 0);
  size_t bytes = numbers * samples * sizeof(float) + mesh.vertices.size() * sizeof(glm::vec3);
  if (!isExact) bytes += CellLevel::bytesNeeded(samples);
  if (!isExact && !isRaster) bytes += VoxelGrid::bytesExpected(samples, triangles);
  if (isExact || options.sign == SignMode::Harmonic || options.closeHoles)
    bytes += SurfaceTree::bytesNeeded(triangles, frames_);
  if (options.sign == SignMode::Exact) bytes += samples * sizeof(uint32_t);  // The list of samples.
  if (isSigned) bytes += crossingBytesExpected(grid.dims) + RayMap::bytesExpected(grid.dims);
  if (options.closeHoles) bytes += kRimBytesPerTriangle * triangles;
  return bytes;
}

void Backend::begin() {
  const auto& [mesh, grid, options, progress, field, machine] = *job_;
  toCellUnits(mesh, grid, mesh_);
  hasSurfaceTree_ = hasCrossings_ = false;
  crossedTurns_.clear();
  changedFaces_ = {};
  windingDipoles_.clear();
  mustFit_ = areRimsFound_ = false;
  const size_t count = grid.sampleCount();
  field.grid = grid;
  field.clampDistance = options.band * grid.spacing;
  field.distance.resizeUninitialized(count);
  field.triangle.resizeUninitialized(options.triangle ? count : 0);
  field.winding.resizeUninitialized(options.winding && options.sign != SignMode::None ? count : 0);
  field.confidence.resizeUninitialized(options.confidence && options.sign != SignMode::None ? count : 0);
  doubtfulShare_ = 0.0;
  patch_.clear();
  faceSides_ = {};
}

const SurfaceTree& Backend::surfaceTree() {
  if (std::exchange(hasSurfaceTree_, true)) return surfaceTree_;
  doubleSided_ = surfaceTree_.buildSingleSided(mesh_, frames_);
  turns_.clear();
  treeTurns_ = TreeTurns::Unasked;
  return surfaceTree_;
}

const SurfaceTree& Backend::turnedSurfaceTree() {
  surfaceTree();
  if (treeTurns_ != TreeTurns::Unasked) return surfaceTree_;
  const auto turns = turnsOfFirsts(doubleSided_, std::move(turns_), mesh().triangles.size());
  const bool areNone = turns && std::ranges::all_of(*turns, [](uint8_t turn) { return turn == kAsGiven; });
  treeTurns_ = areNone ? TreeTurns::None : TreeTurns::Some;
  if (areNone) return surfaceTree_;
  if (turns)
    surfaceTree_.turn(*turns);
  else
    surfaceTree_.build(mesh_);  // Its frames are stored, as the turned triangles do not outlive it.
  return surfaceTree_;
}

void Backend::restoreTree() {
  if (surfaceTree(); treeTurns_ == TreeTurns::Some) {
    mesh_.triangles = mesh().triangles;
    surfaceTree_.buildSingleSided(mesh_, frames_);
    windingDipoles_.clear();
  }
  surfaceTree_.releaseScratch();
}

void Backend::exactDistance() {
  computeExactDistance(surfaceTree(), mesh_.dims, options().band, progress(), job_->field.distance,
                       triangles());
}

void Backend::voxelGrid() {
  const std::vector<CellLattice> lattices = coverMesh(mesh_);
  levels_.resize(lattices.size());
  const size_t left = bytesLeft();
  for (size_t l = 0; l < lattices.size(); ++l)
    buildVoxelGrid(mesh_, lattices[l], left, progress(), levels_[l].grid);
}

void Backend::cellDistance() {
  for (CellLevel& level : levels_) computeCellDistance(mesh_, level.grid, progress(), level.squared);
}

void Backend::rasterDistance() {
  const std::vector<CellLattice> lattices = coverMesh(mesh_);
  levels_.resize(lattices.size());
  for (size_t l = 0; l < lattices.size(); ++l) {
    levels_[l].grid.cells = lattices[l];
    rasterizeDistance(mesh_, lattices[l], progress(), levels_[l].squared);
  }
}

void Backend::distanceTransform() {
  for (CellLevel& level : levels_)
    transformDistance(level.grid.cells.dims, progress(), level.squared, level.nearestCell);
}

void Backend::refine() {
  if (options().distance == DistanceMode::Raster) {
    sampleRasterDistance(mesh_.dims, levels_, progress(), job_->field.distance);
    return;
  }
  const int reach = options().distance == DistanceMode::Neighbours ? 1 : 0;
  refineDistance(mesh_, levels_, reach, progress(), job_->field.distance, triangles());
}

void Backend::crossings() {
  if (!std::exchange(hasCrossings_, true) && !leaveOutDoubleSided()) {
    countCrossings(mesh_, progress(), crossings_);
    return;
  }
  changeCrossings(mesh_, changedFaces_, progress(), crossings_);
  changedFaces_ = {};
}

/// Prepares to count the crossings without the double-sided faces, which cancel, if most faces are. Returns
/// whether it did. Closed holes need to know of all faces.
bool Backend::leaveOutDoubleSided() {
  const size_t count = mesh().triangles.size();
  if (!hasSurfaceTree_ || options().closeHoles || 2 * doubleSided_.count() < count) return false;
  crossedTurns_ = withoutOthers(doubleSided_, count);
  for (const uint32_t face : doubleSided_.firsts) crossedTurns_[face] = kLeftOut;
  for (size_t f = 0; f < count; ++f)
    if (crossedTurns_[f] == kAsGiven) changedFaces_.added.push_back(mesh().triangles[f]);
  clearCrossings(mesh_.dims, crossings_);
  return true;
}

void Backend::rayMap() {
  const size_t needed = RayMap::bytesNeeded(crossings_) + job_->grid.sampleCount() * sizeof(float),
               held = rayMap_.bytes() + windingBuffer().capacityBytes();
  ask(needed - std::min(needed, held), ", because the mesh has many layers");
  buildRayMap(mesh_.dims, crossings_, rayMap_);
}

void Backend::winding(SignMode mode) {
  const auto ask = [this](size_t more) { this->ask(more, ", because the mesh has holes or reversed faces"); };
  const auto rims = [this](SignMode signMode) -> const RimLattices& {
    // A fit needs no rims. `windingDipoles` does, once all faces are chosen.
    const bool areAllTaken =
        !areTurned() || std::ranges::find(crossedTurns_, kLeftOut) == crossedTurns_.end();
    if (signMode != SignMode::Harmonic || !mustFit_ || !areAllTaken) return findRims(signMode);
    areRimsFound_ = false;
    return rims_ = {};
  };
  doubtfulShare_ = windingSolver_.compute(rayMap_, mode, options(), {ask, rims}, progress(), windingBuffer());
}

/// Finds the rims of the faces as the sign takes them.
const RimLattices& Backend::findRims(SignMode mode) {
  areRimsFound_ = true;
  const PackedMesh asTurned{mesh().vertices, mesh_.triangles, mesh().origin};
  if (areTurned()) return rims_ = findRimLattices(asTurned, job_->grid, mode);
  const std::vector<RimEdge>& given = mesh().rims(spacing());
  rims_ = findRimLattices(asTurned, given, job_->grid, mode);
  // An edge of an odd number of faces is a rim, whichever of them are reversed. More rims need a fit, too.
  std::vector<RimEdge> odd;
  std::ranges::copy_if(given, std::back_inserter(odd), [](const RimEdge& e) { return e.times % 2 == 1; });
  mustFit_ = !rims_.haveAll() &&
             (odd.size() == given.size() || !findRimLattices(asTurned, odd, job_->grid, mode).haveAll());
  return rims_;
}

DoubleSidedFaces Backend::doubleSidedFaces() {
  return hasSurfaceTree_ ? doubleSided_ : findDoubleSidedFaces(mesh());
}

void Backend::turnFaces(const Turns& turns) {
  if (crossedTurns_.empty()) crossedTurns_.assign(turns.size(), kAsGiven);
  const std::span<const glm::uvec3> given = mesh().triangles;
  const std::vector<uint32_t> changed =
      parallelSelect(given.size(), [&](uint32_t f) { return turns[f] != crossedTurns_[f]; });
  changedFaces_ = {};
  for (const uint32_t f : changed) {
    auto& [removed, added, reversed] = changedFaces_;
    if (turns[f] == kLeftOut)
      removed.push_back(turned(given[f], crossedTurns_[f]));
    else
      (crossedTurns_[f] == kLeftOut ? added : reversed).push_back(turned(given[f], turns[f]));
  }
  if (!areTurned()) {
    turnedTriangles_.resizeUninitialized(given.size());
    parallelFor(given.size(), kFacesPerTask, [&](size_t begin, size_t end) {
      for (size_t f = begin; f < end; ++f) turnedTriangles_[f] = turned(given[f], turns[f]);
    });
    mesh_.triangles = turnedTriangles_;
  } else {
    for (const uint32_t f : changed) turnedTriangles_[f] = turned(given[f], turns[f]);
  }
  crossedTurns_ = turns;
  if (hasSurfaceTree_) turns_ = turns;
}

double Backend::misfit() const {
  return measureMisfit(mesh_.dims, crossings_, windingBuffer());
}

bool Backend::contradictsParity() {
  return cpu::contradictsParity(rayMap_, windingBuffer(), options().threshold);
}

std::span<const float> Backend::rises() {
  measureSides(kFarSides);
  return rises_;
}

std::span<const float> Backend::parityRises() {
  averageParity(rayMap_, windingBuffer());
  measureSides(0.0f);
  return rises_;
}

NearSides Backend::nearSides() {
  measureSides(0.0f, &wholeness_);
  return {.rises = rises_, .wholeness = wholeness_};
}

/// Measures the field beside the faces as given.
void Backend::measureSides(float farSides, Buffer<float>* wholeness) {
  const Turns asGiven, &turns = areTurned() ? crossedTurns_ : asGiven;
  const std::span<const glm::uvec3> taken = std::exchange(mesh_.triangles, mesh().triangles);
  cpu::measureSides(mesh_, turns, windingBuffer(), farSides, progress(), rises_, wholeness);
  mesh_.triangles = taken;
}

void Backend::windingDipoles() {
  if (doubtfulShare() == 0.0) return;
  if (!areRimsFound_) findRims(SignMode::Harmonic);
  const Buffer<float>& distance = job_->field.distance;
  const double threshold = options().threshold;
  std::vector<uint32_t> doubts =
      findDoubts(mesh_.dims, crossings_, windingBuffer(), distance, rims_.source(), threshold);
  if (doubts.empty()) return;
  if (rims_.looks > 0) {
    const std::vector<uint32_t> unsure = windingDipoles_.settle(
        turnedSurfaceTree(), mesh_.dims, doubts, threshold, {0, rims_.looks}, progress(), windingBuffer());
    std::erase_if(doubts, [&](uint32_t s) {
      return distance[s] > kOnSurface && !std::ranges::binary_search(unsure, s);
    });
  }
  if (!rims_.rims.empty()) settleByRims(rayMap_, rims_, doubts, progress(), windingBuffer());
}

std::vector<MissingEdge> Backend::missingEdges() {
  return findMissingEdges(rayMap_, windingBuffer(), options().threshold, progress());
}

std::vector<float> Backend::windingAt(std::span<const glm::vec3> points) {
  return windingDipoles_.numbersAt([this]() -> const SurfaceTree& { return turnedSurfaceTree(); }, points,
                                   progress());
}

void Backend::ask(size_t more, const char* why) const {
  checkFieldMemory(bytes() + more, mostBytes(), why);
}

size_t Backend::mostBytes() const {
  return mostMemory(job_->machine.memoryLimit, bytes());
}

size_t Backend::bytesLeft() const {
  const size_t most = mostBytes();
  return most - std::min(most, bytes());
}

void Backend::addPatch() {
  patchTree_.build(patch_.mesh);
  addExactDistance(patchTree_, mesh_.dims, progress(), job_->field.distance, triangles());
}

void Backend::sign() {
  applySign(windingBuffer(), options().threshold, options().invert, job_->field.distance);
  if (options().confidence)
    computeConfidence(rayMap_, windingBuffer(), options().threshold, job_->field.confidence);
}

void Backend::finish() {
  finishDistance(options().band, job_->grid.spacing, job_->field.distance);
}

size_t Backend::bytes() const {
  const Field& field = job_->field;
  size_t total = mesh().bytes() + field.distance.capacityBytes() + field.triangle.capacityBytes() +
                 field.winding.capacityBytes() + field.confidence.capacityBytes();
  total += mesh_.vertices.capacityBytes() + turnedTriangles_.capacityBytes() + rises_.capacityBytes() +
           wholeness_.capacityBytes() + surfaceTree_.bytes() + windingSolver_.bytes() +
           windingDipoles_.bytes() + winding_.capacityBytes() + patch_.bytes() + patchTree_.bytes();
  for (const CellLevel& level : levels_) total += level.bytes();
  for (const AxisCrossings& axis : crossings_)
    total += axis.starts.capacityBytes() + axis.entries.capacityBytes();
  return total + rayMap_.bytes() + rims_.bytes();
}

}  // namespace raymap::cpu
