#include "vulkan/runtime/backend.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/memory.h"
#include "base/parallel.h"

namespace raymap::vulkan {

namespace {

// Stages that transfer data between host and device.
constexpr const char* kMeshStage = "begin";
constexpr const char* kReadBackStage = "read_back";
constexpr const char* kFaceSearchStage = "face_search";
constexpr const char* kDistanceStage = "exact_distance";

/// Returns the bytes of the buffer through which a field comes: a quarter of the field. A lower limit keeps
/// the wait shorter than the copy; an upper limit keeps the buffer in the host's caches.
uint64_t pieceBytes(uint64_t fieldBytes) {
  constexpr uint64_t kLeast = uint64_t{1} << 20, kMost = uint64_t{1} << 24;
  return std::min(fieldBytes, std::clamp(fieldBytes / 4, kLeast, kMost));
}

/// Copies from a buffer that the host shares with the device: for one thread that takes longer than the bus.
void copyToHost(std::byte* to, const std::byte* from, size_t bytes) {
  constexpr size_t kGrain = size_t{1} << 18;
  parallelFor(bytes, kGrain,
              [&](size_t begin, size_t end) { std::memcpy(to + begin, from + begin, end - begin); });
}

}  // namespace

Backend::Backend(Device& device)
    : StageRecorder(device),
      upload_(device),
      distance_(device, "distance"),
      triangle_(device, "closest triangle"),
      winding_(device, "winding number"),
      confidence_(device, "confidence"),
      findings_(device, "findings for the host", MemoryUse::ReadBack),
      piece_(device, "piece of a field for the host", MemoryUse::ReadBack),
      commandBuffer_(device) {
  findings_.resize<Findings>(1);
}

void Backend::setJob(const Job& job) {
  job_.emplace(job);
  stages_.clear();
  openStage_ = nullptr;
  start(newCommands(), job.grid, job.options);
}

void Backend::begin() {
  const auto& [mesh, grid, options, progress, field, machine] = *job_;
  isDistanceDue_ = false;
  doubtfulShare_.reset();
  doubleSided_.reset();
  turns_.clear();
  faceSides_ = {};
  patch_.clear();
  upload_.fill(mesh);
  reserve(extentOf(mesh, grid, options));
  reserveResults();
  setResults({.distance = distance_.address(),
              .triangle = options.triangle ? triangle_.address() : 0,
              .winding = options.winding ? winding_.address() : 0,
              .confidence = options.confidence ? confidence_.address() : 0});
  recordMesh(upload_.source());
  if (!extent().searchesFaces || extent().castsRaysFirst) return;
  stopStage();
  startStage(kFaceSearchStage);
  searchFaces();
}

/// The host looks at what the device finds while the device goes on.
void Backend::searchFaces() {
  faceSearch_.record(commands(), mesh_.mesh());
  faceSearchPart_ = submitPart();
}

/// Submits what was recorded of the open stage and those before.
size_t Backend::submitPart() {
  const char* const stage = openStage_;
  stopStage();
  const size_t part = commandBuffer_.submitPart(commands());
  startStage(stage);
  return part;
}

void Backend::exactDistance() {
  isDistanceDue_ = extent().castsRaysFirst;
  if (!isDistanceDue_) recordExactDistance();
}

void Backend::crossings() {
  if (isDistanceDue_) recordTreeWithRays();
  recordCrossings();
  if (extent().castsRaysFirst && extent().searchesFaces) faceSearchPart_ = submitPart();
}

void Backend::recordDueDistance() {
  if (!std::exchange(isDistanceDue_, false)) return;
  const char* const stage = openStage_;
  stopStage();
  startStage(kDistanceStage);
  recordExactDistance();
  submitPart();
  stopStage();
  startStage(stage);
}

StageRecorder::Extent Backend::extentOf(const PackedMesh& mesh, const Grid& grid,
                                        const FieldOptions& options) const {
  Extent extent{.vertices = static_cast<uint32_t>(mesh.vertices.size()),
                .triangles = static_cast<uint32_t>(mesh.triangles.size()),
                .dims = grid.dims,
                .distance = options.distance,
                .sign = options.sign,
                .hasWinding = options.winding,
                .turnsFaces = mayTurnFaces(options),
                .closesHoles = options.closeHoles,
                .findsRims = usesRims(options.sign),
                .searchesFaces = usesRims(options.sign) || mayTurnFaces(options)};
  const bool isExact = options.distance == DistanceMode::Exact;
  extent.castsRaysFirst =
      !job_->machine.progress && areFewSamples(grid.sampleCount(), options.distance) &&
      (isExact ? usesRims(modeBeforeOrientation(options)) : options.sign != SignMode::None);
  if (isExact) return extent;
  const Box box = bounds(mesh);
  const auto inCells = [&](const glm::dvec3& p) { return glm::vec3((p - grid.origin) / grid.spacing); };
  extent.lattices = coverBounds(inCells(box.min), inCells(box.max), grid.dims);
  extent.outside = HUGE_VAL;  // The lattices cover the whole mesh.
  return extent;
}

void Backend::reserveResults() {
  const auto& [mesh, grid, options, progress, field, machine] = *job_;
  const auto reserve = [&, samples = grid.sampleCount()](DeviceBuffer& result, auto& values,
                                                         bool isAskedFor) {
    const size_t count = isAskedFor ? samples : 0;
    result.resize<float>(count);
    values.resizeUninitialized(count);
  };
  field.grid = grid;
  field.clampDistance = options.band * grid.spacing;
  reserve(distance_, field.distance, true);
  reserve(triangle_, field.triangle, options.triangle);
  reserve(winding_, field.winding, options.winding && hasSign());
  reserve(confidence_, field.confidence, options.confidence && hasSign());
  piece_.resize<std::byte>(pieceBytes(distance_.bytes()));
}

void Backend::startStage(const char* name) {
  openStage_ = name;
  commands().startStage(name);
}

void Backend::stopStage() {
  commands().stopStage();
  openStage_ = nullptr;
}

template <class Work>
void Backend::runBeside(Work&& work) {
  const char* const stage = openStage_;
  if (stage) stopStage();
  commandBuffer_.submit();
  try {
    work();
  } catch (...) {  // The device must not read and write what the caller may then release.
    commandBuffer_.wait();
    throw;
  }
  commandBuffer_.wait();
  for (const StageTime& time : commandBuffer_.times()) {
    const double end = time.start + time.milliseconds;
    if (time.name == std::string_view(kMeshStage)) meshReady_ = end;
    if (time.name != std::string_view(kReadBackStage)) fieldReady_ = end;
    const auto known = std::ranges::find(stages_, time.name, &Stats::Stage::name);
    if (known != stages_.end())
      known->milliseconds += time.milliseconds;
    else
      stages_.push_back({time.name, time.milliseconds});
  }
  continueIn(newCommands());
  if (stage) startStage(stage);
}

void Backend::run() {
  runBeside([] {});
}

Commands Backend::newCommands() {
  Commands commands = commandBuffer_.begin();
  commands.listen(this);
  return commands;
}

void Backend::onProgress(double done) {
  if (!job_->machine.progress) return;
  run();
  progress().report(done);
}

double Backend::doubtfulShare() {
  if (doubtfulShare_) return *doubtfulShare_;
  return countDoubtful([] {});
}

const DoubleSidedFaces& Backend::doubleSidedFaces() {
  if (doubleSided_) return *doubleSided_;
  std::optional<std::span<const uint32_t>> faces;
  if (extent().searchesFaces) {
    commandBuffer_.waitForPart(faceSearchPart_);
    faces = faceSearch_.faces();
  }
  return doubleSided_.emplace(faces ? findDoubleSidedFaces(mesh(), *faces) : findDoubleSidedFaces(mesh()));
}

void Backend::searchRims(SignMode mode) {
  Buffer<glm::uvec3> turned;  // A copy takes longer than the search on many threads.
  if (!turns_.empty()) turned = turnedTriangles(mesh().triangles, turns_);
  const std::span<const glm::uvec3> triangles = turns_.empty() ? mesh().triangles : std::span(turned);
  const PackedMesh asTurned(mesh().vertices, triangles, mesh().origin);
  commandBuffer_.waitForPart(faceSearchPart_);
  const auto edges = faceSearch_.edges();
  rims_ = edges ? findRimLattices(asTurned, findRimEdges(asTurned, *edges), grid(), mode)
                : findRimLattices(asTurned, grid(), mode);
  if (mode == SignMode::Harmonic && rims_.rims.size() > kMostRimsInSingles) rims_.rims.clear();
}

void Backend::winding(SignMode mode) {
  rims_ = {};
  recordRays(mode);
  if (usesRims(mode)) {
    const double share = countDoubtful([&] {
      doubleSidedFaces();
      searchRims(mode);
      if (mayTurnFaces(options())) mesh().mayHaveInvertedParts();
    });
    if (share == 0.0) {
      rims_ = {};
      return;
    }
    windingRims_.record(commands(), crossings_.lines(), rims_, results_.winding);
  }
  if (!rims_.haveAll()) recordWinding(mode);
}

void Backend::windingDipoles() {
  if (doubtfulShare() == 0.0) return;
  const bool rimsDecide = !rims_.rims.empty(), usesDipoles = rims_.looks > 0;
  if (!rimsDecide && !usesDipoles) return;
  recordDoubts();
  if (usesDipoles) recordDipoles({rims_.looks, rimsDecide});
  if (rimsDecide)
    windingRims_.recordSettling(commands(), crossings_.lines(), results_.distance,
                                usesDipoles ? 0 : windingDoubts_.change().address(), options().threshold,
                                results_.winding);
}

template <class Work>
double Backend::countDoubtful(Work&& work) {
  recordFindings({{findings_.handle(), findings_.offset()}});
  const size_t part = submitPart();
  recordDueDistance();
  try {
    work();
  } catch (...) {  // The device must not read and write what the caller may then release.
    commandBuffer_.waitForParts();
    throw;
  }
  commandBuffer_.waitForPart(part);
  const Findings& findings = findings_.mapped<Findings>().front();
  if (std::optional<Error> error = failureOf(findings.crossings)) throw *error;
  doubtfulShare_ = double(findings.doubtful) / double(sampleCount());
  return *doubtfulShare_;
}

void Backend::turnFaces(const Turns& turns) {
  turns_ = turns;
  doubtfulShare_.reset();
  commandBuffer_.waitForParts();  // They read the triangles that are replaced here.
  upload_.turn(mesh(), turns);
  recordMesh(upload_.source());
  if (extent().searchesFaces) searchFaces();
}

double Backend::misfit() {
  orientation_.recordMisfit(commands(), orientationFields());
  run();
  return orientation_.misfit();
}

std::span<const float> Backend::rises() {
  return measureRises(kFarSides);
}

std::span<const float> Backend::parityRises() {
  orientation_.recordParity(commands(), orientationFields());
  return measureRises(0.0f);
}

NearSides Backend::nearSides() {
  const std::span<const float> rises = measureRises(0.0f);
  orientation_.recordSides(commands(), orientationFields(), 0.0f, SideMeasure::Wholeness);
  run();
  return {.rises = rises, .wholeness = orientation_.sides()};
}

/// Negates the values of reversed faces, because the host has them as given.
std::span<const float> Backend::measureRises(float farSides) {
  orientation_.recordSides(commands(), orientationFields(), farSides, SideMeasure::Rise);
  run();
  const std::span<const float> rises = orientation_.sides();
  rises_.assign(rises.begin(), rises.end());
  for (size_t f = 0; f < turns_.size(); ++f)
    if (turns_[f] == kReversed) rises_[f] = -rises_[f];
  return rises_;
}

std::vector<MissingEdge> Backend::missingEdges() {
  do {
    closeHoles_.recordSearch(commands(), extent().dims, crossings_.crossed(), results_.winding,
                             options().threshold);
    run();
  } while (closeHoles_.growIfFull());
  return closeHoles_.edges();
}

std::vector<float> Backend::windingAt(std::span<const glm::vec3> points) {
  closeHoles_.recordNumbersAt(commands(), windingDipoles_, surfaceTree(), points, options().threshold);
  run();
  return closeHoles_.numbers();
}

const CellMesh& Backend::cellMesh() {
  toCellUnits(mesh(), grid(), cellMesh_);
  if (!turns_.empty()) {
    turnedTriangles_ = turnedTriangles(mesh().triangles, turns_);
    cellMesh_.triangles = turnedTriangles_;
  }
  return cellMesh_;
}

size_t Backend::bytesLeft() const {
  const size_t left = memoryLeft();
  return job_->machine.memoryLimit == 0 ? left : std::min<size_t>(left, device_->memoryLeft());
}

void Backend::addPatch() {
  closeHoles_.recordDistance(commands(), patch_, {results_.distance, results_.triangle});
  cellMesh_.vertices.release();
  turnedTriangles_.release();
}

bool Backend::complete() {
  commands().concurrent([&] {
    recordFindings({{findings_.handle(), findings_.offset()}});
    recordPart(distance_, 0);
  });
  run();
  const Findings& findings = findings_.mapped<Findings>().front();
  if (fits(findings)) return true;
  grow(findings);
  return false;
}

void Backend::readResults() {
  const Status status = describe(findings_.mapped<Findings>().front());
  if (status.error) throw *status.error;
  doubtfulShare_ = status.doubtfulShare;
  Field& field = job_->field;
  readBack(distance_, field.distance.data(), true);
  readBack(triangle_, field.triangle.data());
  readBack(winding_, field.winding.data());
  readBack(confidence_, field.confidence.data());
}

uint64_t Backend::partBytes(const DeviceBuffer& result) const {
  return result.bytes() <= piece_.bytes() ? result.bytes() : piece_.bytes() / 8 * 4;
}

/// Records the copy of a part to its half of the buffer for the host.
void Backend::recordPart(const DeviceBuffer& result, uint64_t first) {
  const uint64_t each = partBytes(result);
  startStage(kReadBackStage);
  commands().copy(result, piece_.handle(), piece_.offset() + first / each % 2 * each,
                  std::min(each, result.bytes() - first), first);
  stopStage();
}

/// Copies part by part: a buffer for the whole field would take a sixth of a run's memory. The device fills
/// one half of the buffer while the host empties the other.
void Backend::readBack(const DeviceBuffer& result, void* to, bool isFirstThere) {
  const uint64_t bytes = result.bytes(), each = partBytes(result);
  if (bytes > 0 && !isFirstThere) {
    recordPart(result, 0);
    run();
  }
  for (uint64_t first = 0; first < bytes; first += each) {
    const auto keep = [&] {
      copyToHost(static_cast<std::byte*>(to) + first,
                 piece_.mapped<std::byte>().data() + first / each % 2 * each, std::min(each, bytes - first));
    };
    if (first + each >= bytes) return keep();
    recordPart(result, first + each);
    runBeside(keep);
  }
}

}  // namespace raymap::vulkan
