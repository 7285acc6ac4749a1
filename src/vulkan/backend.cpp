#include "backend.h"

#include <raymap/error.h>

#include <cstring>

#include "pipeline.h"

namespace raymap::vulkan {

namespace {

// What crosses the bus.
constexpr const char* kMeshStage = "begin";
constexpr const char* kReadBackStage = "read_back";

}  // namespace

Backend::Backend(Device& device)
    : StageRecorder(device),
      device_(&device),
      commandBuffer_(device),
      upload_(device),
      distance_(makeResult("distance")),
      triangle_(makeResult("closest triangle")),
      winding_(makeResult("winding number")),
      confidence_(makeResult("confidence")),
      findings_(device, "findings for the host", MemoryUse::ReadBack) {
  findings_.resize<Findings>(1);
}

size_t Backend::bytesNeeded(const Mesh& mesh, const Grid& grid, const Options& options) {
  const bool isSigned = options.sign != SignMode::None;
  constexpr size_t kResult = 2 * sizeof(float);  // Here, and on its way to the host.
  size_t perSample = kResult;
  if (options.triangleIds) perSample += kResult;
  if (options.confidence && isSigned) perSample += kResult;
  if (isSigned) perSample += 3 * sizeof(int32_t) + (options.winding ? kResult : sizeof(float));
  if (options.sign == SignMode::Paths || options.sign == SignMode::Evolution) perSample += sizeof(float);
  perSample += options.distance == DistanceMode::Exact ? 2 : 4 * sizeof(float);
  size_t coarse = 0;
  for (int level = 1; options.sign == SignMode::Harmonic && level <= coarsestHarmonicLevel(grid.dims);
       ++level)
    coarse += 4 * sizeof(float) * harmonicBox(grid.dims, level).sampleCount();
  constexpr size_t kPerTriangle = 160;
  return coarse + grid.sampleCount() * perSample + mesh.triangles.size() * kPerTriangle +
         mesh.vertices.size() * 2 * sizeof(glm::vec3);
}

Backend::Result Backend::makeResult(const std::string& name) {
  return {DeviceBuffer(*device_, name), DeviceBuffer(*device_, name + " for the host", MemoryUse::ReadBack)};
}

void Backend::begin(const Mesh& mesh, const Grid& grid, const Options& options, Progress& progress,
                    Field& field) {
  inputMesh_ = &mesh;
  progress_ = &progress;
  field_ = &field;
  doubtfulShare_ = 0.0;
  stages_.clear();
  upload_.fill(mesh);
  reserve(extentOf(mesh, grid, options));
  reserveResults(grid, options);
  StageRecorder::begin(commandBuffer_.begin(), grid, options,
                       {.distance = distance_.device.address(),
                        .triangle = addressOf(triangle_),
                        .winding = addressOf(winding_),
                        .confidence = addressOf(confidence_)});
  stage(kMeshStage, [&] { recordMesh(upload_.source()); });
}

StageRecorder::Extent Backend::extentOf(const Mesh& mesh, const Grid& grid, const Options& options) const {
  Extent extent{.vertices = static_cast<uint32_t>(mesh.vertices.size()),
                .triangles = static_cast<uint32_t>(mesh.triangles.size()),
                .dims = grid.dims,
                .distance = options.distance,
                .sign = options.sign};
  if (options.distance == DistanceMode::Exact) return extent;
  const Box box = bounds(mesh);
  const auto inCells = [&](const glm::dvec3& p) { return glm::vec3((p - grid.origin) / grid.spacing); };
  extent.lattices = coverBounds(inCells(box.min), inCells(box.max), grid.dims);
  extent.outside = HUGE_VAL;  // They cover all of it.
  return extent;
}

void Backend::reserveResults(const Grid& grid, const Options& options) {
  const size_t count = grid.sampleCount();
  const bool isSigned = hasSign();
  const auto reserve = [&](Result& result, auto& values, bool isAskedFor, bool isNeeded) {
    result.device.resize<float>(isNeeded ? count : 0);
    result.host.resize<float>(isAskedFor ? count : 0);
    values.resize(isAskedFor ? count : 0);
  };
  field_->grid = grid;
  field_->band = options.band * grid.spacing;
  reserve(distance_, field_->distance, true, true);
  reserve(triangle_, field_->triangle, options.triangleIds, options.triangleIds);
  reserve(winding_, field_->winding, options.winding && isSigned, isSigned);
  reserve(confidence_, field_->confidence, options.confidence && isSigned, options.confidence && isSigned);
}

/// 0 if it is not asked for.
VkDeviceAddress Backend::addressOf(const Result& result) {
  return result.device.bytes() > 0 ? result.device.address() : 0;
}

/// Where somebody watches the progress, or may cancel, stages run one by one.
void Backend::afterStage() {
  if (!options_->progress) return;
  recordFindings(findings_.handle(), findings_.offset());
  run();
  commands_ = commandBuffer_.begin();
}

void Backend::run() {
  commandBuffer_.submitAndWait();
  commands_.reset();
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

bool Backend::growIfFull() {
  const Findings& findings = findings_.mapped<Findings>().front();
  if (fits(findings)) return false;
  grow(findings);
  return true;
}

/// Again with more room until it fits, where it has run by now; else `finish` looks.
void Backend::voxelGrid() {
  do StageRecorder::voxelGrid();
  while (options_->progress && growIfFull());
}

void Backend::rasterDistance() {
  do StageRecorder::rasterDistance();
  while (options_->progress && growIfFull());
}

void Backend::finish() {
  commands_->stage("finish", [&] { recordFinish(); });
  commands_->stage(kReadBackStage, [&] {
    commands_->concurrent([&] {
      for (Result* result : {&distance_, &triangle_, &winding_, &confidence_}) readBack(*result);
    });
    recordFindings(findings_.handle(), findings_.offset());
  });
  run();
  if (growIfFull()) return runPipeline(*this, *inputMesh_, *grid_, *options_, *progress_, *field_);
  takeResults();
}

void Backend::readBack(Result& result) {
  if (result.host.bytes() > 0) commands_->copy(result.device, result.host, result.host.bytes());
}

void Backend::takeResults() {
  const Status status = describe(findings_.mapped<Findings>().front());
  if (status.error) throw *status.error;
  doubtfulShare_ = status.doubtfulShare;
  const auto take = [](const Result& result, auto& values) {
    if (!values.empty())
      std::memcpy(values.data(), result.host.mapped<std::byte>().data(), result.host.bytes());
  };
  take(distance_, field_->distance);
  take(triangle_, field_->triangle);
  take(winding_, field_->winding);
  take(confidence_, field_->confidence);
}

}  // namespace raymap::vulkan
