#include "vulkan/runtime/stage_recorder.h"

#include <cstddef>
#include <utility>

#include "base/text.h"
#include "method/orientation_sides.h"

namespace raymap::vulkan {

StageRecorder::StageRecorder(Device& device)
    : device_(&device),
      scratch_(device),
      mesh_(device),
      faceSearch_(device, &scratch_),
      crossings_(device, &scratch_),
      orientation_(device),
      windingDoubts_(device),
      windingDipoles_(device, &scratch_),
      windingRims_(device, &scratch_),
      closeHoles_(device),
      surfaceTree_(device),
      exactDistance_(device, &scratch_),
      refine_(device, &scratch_),
      rasterDistance_(device),
      rayMap_(device),
      windingRays_(device),
      windingPaths_(device, &scratch_),
      windingHarmonic_(device, &scratch_),
      finish_(device),
      windingNumber_(device, "winding number", &scratch_) {}

void StageRecorder::reserve(const Extent& extent) {
  extent_ = extent;
  const bool isHarmonic = extent.sign == SignMode::Harmonic;
  mesh_.reserve(extent.vertices, extent.triangles);
  if (isExact() || isHarmonic || extent.closesHoles) surfaceTree_.reserve(extent.triangles);
  // The sign needs only the distances themselves, so the stages of both share their scratch memory.
  scratch_.startPhase();
  const size_t afterRays = hasSign() ? reserveSign() : 0;
  const size_t first = extent.castsRaysFirst ? afterRays : 0;
  scratch_.startPhase(first);
  if (extent.searchesFaces) faceSearch_.reserve(extent.vertices, extent.triangles);
  // Lists of cells are made beside the search for faces.
  if (isExact() || !extent.castsRaysFirst) scratch_.startPhase(first);
  // Reserved last, because the levels of cells keep addresses.
  if (isExact())
    exactDistance_.reserve(extent.dims);
  else
    reserveCells();
}

size_t StageRecorder::reserveSign() {
  const glm::ivec3& dims = extent_.dims;
  crossings_.reserve(dims, extent_.triangles, extent_.closesHoles);
  windingNumber_.resize<float>(extent_.hasWinding ? 0 : sampleCount());
  const size_t solve = scratch_.next();
  if (extent_.sign == SignMode::Paths || extent_.sign == SignMode::Evolution) windingPaths_.reserve(dims);
  if (extent_.sign == SignMode::Harmonic || extent_.turnsFaces) windingHarmonic_.reserve(dims);
  if (extent_.turnsFaces) orientation_.reserve(dims, extent_.triangles);
  if (extent_.findsRims) {
    scratch_.startPhase(solve);  // Rims make the solve unnecessary.
    windingRims_.reserve(dims);
  }
  scratch_.startPhase(solve);  // The dipoles come after the solve.
  if (extent_.sign == SignMode::Harmonic || extent_.closesHoles)
    windingDipoles_.reserve(extent_.triangles, dims);
  return solve;
}

void StageRecorder::start(const Commands& commands, const Grid& grid, const FieldOptions& options) {
  commands_ = commands;
  grid_ = &grid;
  options_ = &options;
}

void StageRecorder::setResults(const Results& results) {
  results_ = results;
  if (results.winding == 0) results_.winding = windingNumber_.address();
}

void StageRecorder::recordMesh(const CellMeshStage::Source& source) {
  const auto mesh = [&] {
    mesh_.record(*commands_, source, *grid_, extent_.outside,
                 extent_.searchesFaces ? faceSearch_.vertexHashes() : 0);
  };
  commands_->lockstep({mesh, [&] { surfaceTree_.recordClear(*commands_); }});
  hasSurfaceTree_ = hasRays_ = false;
}

void StageRecorder::recordWithRays(const std::function<void()>& chain) {
  if (!extent_.castsRaysFirst) return chain();
  const auto rays = [&] {
    recordCrossings();
    rayMap();
    recordRays(modeBeforeOrientation(*options_));
  };
  const auto faces = [&] {
    if (extent_.searchesFaces) faceSearch_.record(*commands_, mesh_.mesh());
  };
  commands_->lockstep({chain, rays, faces});
  hasRays_ = true;
}

void StageRecorder::recordTreeWithRays() {
  if (!extent_.castsRaysFirst) return;
  recordWithRays([&] { recordTree(); });
  hasSurfaceTree_ = true;
}

void StageRecorder::recordExactDistance() {
  exactDistance_.record(*commands_, surfaceTree(), options_->band,
                        {.distance = results_.distance, .triangle = results_.triangle});
}

const SurfaceTreeStage& StageRecorder::surfaceTree() {
  if (!std::exchange(hasSurfaceTree_, true)) recordTree();
  return surfaceTree_;
}

void StageRecorder::recordWinding(SignMode mode) {
  const WindingFields fields{.rays = crossings_.lines().axes,
                             .winding = results_.winding,
                             .doubtful = windingRays_.doubtful().address()};
  if (mode == SignMode::Harmonic) windingHarmonic_.record(*commands_, fields);
  if (mode == SignMode::Paths) windingPaths_.recordAverage(*commands_, fields, *options_);
  if (mode == SignMode::Evolution) windingPaths_.recordEvolution(*commands_, fields, *options_);
}

void StageRecorder::recordDoubts() {
  windingDoubts_.record(*commands_, crossings_.lines(), results_.winding, windingRays_.doubtful().address());
}

OrientationStage::Fields StageRecorder::orientationFields() const {
  return {.rays = crossings_.lines(),
          .field = results_.winding,
          .mesh = mesh_.mesh(),
          .threshold = options_->threshold};
}

void StageRecorder::recordDipoles(WindingDipolesStage::Looks looks) {
  windingDipoles_.record(*commands_, surfaceTree(),
                         {.distance = results_.distance,
                          .winding = results_.winding,
                          .disagreeing = windingRays_.doubtful().address(),
                          .change = windingDoubts_.change().address()},
                         looks, options_->threshold);
}

void StageRecorder::recordFinish() {
  FinishStage::Fields fields{.distance = results_.distance};
  if (hasSign())
    fields = {.rays = crossings_.lines().axes,
              .winding = results_.winding,
              .distance = results_.distance,
              .confidence = results_.confidence};
  finish_.record(*commands_, fields, glm::uvec3(extent_.dims),
                 {.threshold = options_->threshold,
                  .isInverted = options_->invert,
                  .band = options_->band,
                  .spacing = grid_->spacing});
}

void StageRecorder::recordFindings(std::initializer_list<BufferRange> targets) {
  const auto copy = [&](const DeviceBuffer& from, size_t part) {
    for (const BufferRange& to : targets)
      if (to.buffer) commands_->copy(from, to.buffer, to.offset + part, from.bytes());
  };
  commands_->concurrent([&] {
    copy(mesh_.status(), offsetof(Findings, mesh));
    if (hasSign()) {
      copy(crossings_.status(), offsetof(Findings, crossings));
      copy(windingRays_.doubtful(), offsetof(Findings, doubtful));
    }
    if (isExact()) return;
    for (size_t l = 0; l < extent_.lattices.size(); ++l)
      copy(levels_[l]->grid.totals(), offsetof(Findings, lists) + l * sizeof(VoxelGridTotals));
  });
}

Status StageRecorder::describe(const Findings& findings) const {
  Status status{.error = errorOf(findings),
                .triangles = findings.mesh.badTriangles,
                .outside = isExact() ? 0 : findings.mesh.outside};
  if (hasSign()) status.doubtfulShare = double(findings.doubtful) / double(sampleCount());
  if (isExact()) return status;
  for (size_t l = 0; l < extent_.lattices.size(); ++l) {
    const ListSizes sizes = sizesOf(findings.lists[l]);
    status.lists.rows = std::max(status.lists.rows, sizes.rows);
    status.lists.entries = std::max(status.lists.entries, sizes.entries);
  }
  return status;
}

std::optional<Error> StageRecorder::errorOf(const Findings& findings) const {
  const CellMeshStatus& mesh = findings.mesh;
  if (!fits(findings))
    return Error(
        ErrorCode::Memory,
        "the lists of the cells' triangles exceeded their capacity; reserve the sizes in the status");
  if (hasSign())
    if (std::optional<Error> error = failureOf(findings.crossings)) return error;
  if (mesh.badTriangles > 0)
    return Error(ErrorCode::Input,
                 std::to_string(mesh.badTriangles) + " triangles were left out, the first is number " +
                     std::to_string(~mesh.firstBad) +
                     ": a vertex index is out of range, or a vertex not finite or too far away");
  if (!isExact() && mesh.outside > 0)
    return Error(ErrorCode::Input,
                 std::to_string(mesh.outside) + " triangles reach more than " + numberText(extent_.outside) +
                     " samples beyond the grid, outside the searched range; reserve a larger `outside`");
  return std::nullopt;
}

}  // namespace raymap::vulkan
