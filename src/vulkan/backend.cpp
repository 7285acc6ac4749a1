#include "backend.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstring>

#include "pipeline.h"

namespace raymap::vulkan {

namespace {

// What crosses the bus.
constexpr const char* kMeshStage = "begin";
constexpr const char* kReadBackStage = "read_back";

/// What of a field crosses at once: a quarter, but neither so little that waiting for it takes longer than
/// copying, nor so much that it does not stay in the host's caches.
uint64_t pieceBytes(uint64_t fieldBytes) {
  constexpr uint64_t kLeast = uint64_t{1} << 20, kMost = uint64_t{1} << 24;
  return std::min(fieldBytes, std::clamp(fieldBytes / 4, kLeast, kMost));
}

/// While the sign is found, beside the results.
size_t signBytes(const glm::ivec3& dims, const Options& options) {
  const glm::u64vec3 n(dims);
  const size_t samples = n.x * n.y * n.z;
  size_t numbers = 3 * samples + n.x * n.y + n.y * n.z + n.z * n.x;  // The ray map.
  if (!options.winding) numbers += samples;
  if (options.sign == SignMode::Paths || options.sign == SignMode::Evolution) numbers += samples;
  const bool isSolved = options.sign == SignMode::Harmonic || mayTurnFaces(options, 1.0);
  for (int level = 1; isSolved && level <= coarsestHarmonicLevel(dims); ++level)
    numbers += 2 * harmonicBox(dims, level).sampleCount();
  return numbers * sizeof(float);
}

}  // namespace

Backend::Backend(Device& device)
    : StageRecorder(device),
      device_(&device),
      commandBuffer_(device),
      upload_(device),
      distance_(device, "distance"),
      triangle_(device, "closest triangle"),
      winding_(device, "winding number"),
      confidence_(device, "confidence"),
      findings_(device, "findings for the host", MemoryUse::ReadBack),
      piece_(device, "piece of a field for the host", MemoryUse::ReadBack) {
  findings_.resize<Findings>(1);
}

size_t Backend::bytesNeeded(const Mesh& mesh, const Grid& grid, const Options& options) {
  constexpr size_t kNumber = sizeof(float);
  const size_t perTriangle = kBytesPerTriangle + (mayTurnFaces(options, 1.0) ? 2 * kNumber : 0);
  const size_t samples = grid.sampleCount();
  const bool isSigned = options.sign != SignMode::None;
  const size_t results = size_t{1} + (options.triangleIds ? 1 : 0) + (isSigned && options.winding ? 1 : 0) +
                         (isSigned && options.confidence ? 1 : 0);
  // Distances and sign share their memory.
  const size_t distances = options.distance == DistanceMode::Exact ? samples * 2 : 4 * kNumber * samples;
  const size_t signs = isSigned ? signBytes(grid.dims, options) : 0;
  // Lists of blocks, and which edges are crossed.
  const size_t closing = options.closeHoles ? samples * 5 / 2 : 0;
  return kNumber * results * samples + pieceBytes(kNumber * samples) + std::max(distances, signs) + closing +
         mesh.triangles.size() * perTriangle + mesh.vertices.size() * 2 * sizeof(glm::vec3);
}

void Backend::begin(const Mesh& mesh, const Grid& grid, const Options& options, Progress& progress,
                    Field& field) {
  inputMesh_ = &mesh;
  progress_ = &progress;
  field_ = &field;
  doubtfulShare_ = 0.0;
  doubtfulGiven_.reset();
  faceSides_ = {};
  patch_.clear();
  stages_.clear();
  upload_.fill(mesh);
  reserve(extentOf(mesh, grid, options));
  reserveResults(grid, options);
  StageRecorder::begin(commandBuffer_.begin(), grid, options,
                       {.distance = distance_.address(),
                        .triangle = options.triangleIds ? triangle_.address() : 0,
                        .winding = options.winding ? winding_.address() : 0,
                        .confidence = options.confidence ? confidence_.address() : 0});
  stage(kMeshStage, [&] { recordMesh(upload_.source()); });
}

StageRecorder::Extent Backend::extentOf(const Mesh& mesh, const Grid& grid, const Options& options) const {
  Extent extent{.vertices = static_cast<uint32_t>(mesh.vertices.size()),
                .triangles = static_cast<uint32_t>(mesh.triangles.size()),
                .dims = grid.dims,
                .distance = options.distance,
                .sign = options.sign,
                .hasWinding = options.winding,
                .turnsFaces = mayTurnFaces(options, 1.0),
                .closesHoles = options.closeHoles};
  if (options.distance == DistanceMode::Exact) return extent;
  const Box box = bounds(mesh);
  const auto inCells = [&](const glm::dvec3& p) { return glm::vec3((p - grid.origin) / grid.spacing); };
  extent.lattices = coverBounds(inCells(box.min), inCells(box.max), grid.dims);
  extent.outside = HUGE_VAL;  // They cover all of it.
  return extent;
}

void Backend::reserveResults(const Grid& grid, const Options& options) {
  const auto reserve = [&](DeviceBuffer& result, auto& values, bool isAskedFor) {
    const size_t count = isAskedFor ? grid.sampleCount() : 0;
    result.resize<float>(count);
    values.resize(count);
  };
  field_->grid = grid;
  field_->band = options.band * grid.spacing;
  reserve(distance_, field_->distance, true);
  reserve(triangle_, field_->triangle, options.triangleIds);
  reserve(winding_, field_->winding, options.winding && hasSign());
  reserve(confidence_, field_->confidence, options.confidence && hasSign());
  piece_.resize<std::byte>(pieceBytes(distance_.bytes()));
}

/// Where somebody watches the progress, or may cancel, stages run one by one.
void Backend::afterStage() {
  if (!options().progress) return;
  recordFindings(findings_.handle(), findings_.offset());
  run();
  continueIn(commandBuffer_.begin());
}

void Backend::run() {
  commandBuffer_.submitAndWait();
  for (const StageTime& time : commandBuffer_.times()) {
    const double end = time.start + time.milliseconds;
    if (time.name == std::string_view(kMeshStage)) meshReady_ = end;
    if (time.name != std::string_view(kReadBackStage)) fieldReady_ = end;
    if (!stages_.empty() && stages_.back().name == time.name)
      stages_.back().milliseconds += time.milliseconds;
    else
      stages_.push_back({time.name, time.milliseconds});
  }
}

double Backend::readDoubtfulShare(const char* stage) {
  run(stage, [&] { recordFindings(findings_.handle(), findings_.offset()); });
  const Findings& findings = findings_.mapped<Findings>().front();
  if (std::optional<Error> error = failureOf(findings.crossings)) throw *error;
  return double(findings.doubtful) / double(sampleCount());
}

bool Backend::growIfFull() {
  const Findings& findings = findings_.mapped<Findings>().front();
  if (fits(findings)) return false;
  grow(findings);
  return true;
}

/// Again with more room until it fits, where it has run by now; else `finish` looks.
void Backend::voxelGrid() {
  do StageRecorder::voxelGrid();
  while (options().progress && growIfFull());
}

void Backend::rasterDistance() {
  do StageRecorder::rasterDistance();
  while (options().progress && growIfFull());
}

void Backend::finish() {
  commands().stage("finish", [&] { recordFinish(); });
  recordFindings(findings_.handle(), findings_.offset());
  recordPiece(distance_, 0);
  run();
  if (growIfFull()) return runPipeline(*this, *inputMesh_, grid(), options(), *progress_, *field_);
  takeResults();
}

void Backend::takeResults() {
  const Status status = describe(findings_.mapped<Findings>().front());
  if (status.error) throw *status.error;
  doubtfulShare_ = doubtfulGiven_.value_or(status.doubtfulShare);
  readBack(distance_, field_->distance.data(), true);
  readBack(triangle_, field_->triangle.data());
  readBack(winding_, field_->winding.data());
  readBack(confidence_, field_->confidence.data());
}

void Backend::recordPiece(const DeviceBuffer& result, uint64_t first) {
  commands().stage(kReadBackStage, [&] {
    commands().copyPart(result, first, piece_, std::min(piece_.bytes(), result.bytes() - first));
  });
}

/// Piece by piece: memory for the host to see all of it at once would be a sixth of what a run holds.
void Backend::readBack(const DeviceBuffer& result, void* to, bool isFirstThere) {
  for (uint64_t done = 0; done < result.bytes(); done += piece_.bytes()) {
    if (done > 0 || !isFirstThere) {
      continueIn(commandBuffer_.begin());
      recordPiece(result, done);
      run();
    }
    std::memcpy(static_cast<std::byte*>(to) + done, piece_.mapped<std::byte>().data(),
                std::min(piece_.bytes(), result.bytes() - done));
  }
}

}  // namespace raymap::vulkan
