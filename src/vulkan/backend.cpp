#include "backend.h"

#include <raymap/error.h>

#include <cstring>

namespace raymap::vulkan {

namespace {

// What crosses the bus.
constexpr const char* kMeshStage = "begin";
constexpr const char* kReadBackStage = "read_back";

}  // namespace

Backend::Backend(Device& device)
    : device_(&device),
      commandBuffer_(device),
      mesh_(device),
      surfaceTree_(device),
      exactDistance_(device),
      refine_(device),
      rasterSamples_(device),
      crossings_(device),
      rayMap_(device),
      windingRays_(device),
      windingPaths_(device),
      windingHarmonic_(device),
      windingDipoles_(device),
      sign_(device),
      distance_(makeResult("distance")),
      triangle_(makeResult("closest triangle")),
      winding_(makeResult("winding number")),
      confidence_(makeResult("confidence")),
      crossingsStatus_(device, "crossings status for the host", MemoryUse::ReadBack),
      doubtful_(device, "doubtful samples for the host", MemoryUse::ReadBack) {
  crossingsStatus_.resize<CrossingsStatus>(1);
  doubtful_.resize<uint32_t>(1);
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

void Backend::begin(const Mesh& mesh, const Grid& grid, const Options& options, Progress&, Field& field) {
  inputMesh_ = &mesh;
  grid_ = &grid;
  options_ = &options;
  field_ = &field;
  doubtfulShare_ = 0.0;
  stages_.clear();
  mesh_.reserve(mesh);
  reserveResults();
  reserveStages();
  commands_ = commandBuffer_.begin();
  stage(kMeshStage, [&] { mesh_.record(*commands_, mesh, grid); });
}

void Backend::reserveStages() {
  const uint32_t triangles = mesh_.triangleCount();
  const glm::ivec3& dims = grid_->dims;
  const bool isExact = options_->distance == DistanceMode::Exact;
  const bool isHarmonic = options_->sign == SignMode::Harmonic;
  if (options_->sign == SignMode::Paths || options_->sign == SignMode::Evolution) windingPaths_.reserve(dims);
  if (isExact || isHarmonic) surfaceTree_.reserve(triangles);
  if (isExact) exactDistance_.reserve(dims);
  if (hasSign()) crossings_.reserve(dims, triangles);
  if (!isHarmonic) return;
  windingHarmonic_.reserve(dims);
  windingDipoles_.reserve(triangles, dims);
}

void Backend::reserveResults() {
  const size_t count = grid_->sampleCount();
  const bool isSigned = hasSign();
  const auto reserve = [&](Result& result, auto& values, bool isAskedFor, bool isNeeded) {
    result.device.resize<float>(isNeeded ? count : 0);
    result.host.resize<float>(isAskedFor ? count : 0);
    values.resize(isAskedFor ? count : 0);
  };
  field_->grid = *grid_;
  field_->band = options_->band * grid_->spacing;
  reserve(distance_, field_->distance, true, true);
  reserve(triangle_, field_->triangle, options_->triangleIds, options_->triangleIds);
  reserve(winding_, field_->winding, options_->winding && isSigned, isSigned);
  reserve(confidence_, field_->confidence, options_->confidence && isSigned,
          options_->confidence && isSigned);
}

/// 0 if it is not asked for.
VkDeviceAddress Backend::addressOf(const Result& result) {
  return result.device.bytes() > 0 ? result.device.address() : 0;
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

void Backend::exactDistance() {
  stage("exact_distance", [&] {
    recordSurfaceTree();
    exactDistance_.record(*commands_, surfaceTree_, options_->band,
                          {.distance = distance_.device.address(), .triangle = addressOf(triangle_)});
  });
}

void Backend::recordSurfaceTree() {
  surfaceTree_.record(*commands_,
                      {.vertices = mesh_.vertexBuffer().address(),
                       .triangles = mesh_.triangleBuffer().address(),
                       .vertexCount = mesh_.vertexCount(),
                       .triangleCount = mesh_.triangleCount()},
                      grid_->dims);
}

void Backend::crossings() {
  stage("crossings", [&] {
    crossings_.record(*commands_, mesh_.vertexBuffer().address(), mesh_.triangleBuffer().address());
  });
}

void Backend::rayMap() {
  stage("ray_map", [&] { rayMap_.record(*commands_, crossings_.lines()); });
}

void Backend::winding() {
  stage("winding", [&] {
    windingRays_.record(*commands_, crossings_.lines(), winding_.device.address());
    if (options_->sign == SignMode::Harmonic)
      recordHarmonic();
    else if (options_->sign != SignMode::Rays)
      recordPaths();
  });
}

void Backend::recordPaths() {
  const WindingPaths::Fields fields{.rays = crossings_.lines().axes,
                                    .winding = winding_.device.address(),
                                    .doubtful = windingRays_.doubtful().address()};
  if (options_->sign == SignMode::Paths)
    windingPaths_.recordAverage(*commands_, fields, *options_);
  else
    windingPaths_.recordEvolution(*commands_, fields, *options_);
}

void Backend::recordHarmonic() {
  windingHarmonic_.record(*commands_, {.rays = crossings_.lines().axes,
                                       .winding = winding_.device.address(),
                                       .doubtful = windingRays_.doubtful().address()});
  if (options_->distance != DistanceMode::Exact) recordSurfaceTree();
  windingDipoles_.record(*commands_, surfaceTree_,
                         {.distance = distance_.device.address(),
                          .winding = winding_.device.address(),
                          .disagreeing = windingRays_.doubtful().address()},
                         options_->threshold);
}

/// Before anything has run: stages are only recorded so far, but where somebody watches.
void Backend::closeHoles() {
  throw Error(ErrorCode::Unsupported, "holes are closed by the CPU only so far; use --device cpu");
}

void Backend::sign() {
  stage("sign", [&] {
    sign_.record(*commands_,
                 {.rays = crossings_.lines().axes,
                  .winding = winding_.device.address(),
                  .distance = distance_.device.address(),
                  .confidence = addressOf(confidence_)},
                 glm::uvec3(grid_->dims), options_->threshold, options_->invert);
  });
}

void Backend::finish() {
  commands_->stage("finish", [&] {
    sign_.recordFinish(*commands_, distance_.device.address(), static_cast<uint32_t>(grid_->sampleCount()),
                       options_->band, grid_->spacing);
  });
  commands_->stage(kReadBackStage, [&] {
    commands_->concurrent([&] {
      for (Result* result : {&distance_, &triangle_, &winding_, &confidence_}) readBack(*result);
      if (!hasSign()) return;
      commands_->copy(crossings_.status(), crossingsStatus_, crossingsStatus_.bytes());
      commands_->copy(windingRays_.doubtful(), doubtful_, doubtful_.bytes());
    });
  });
  run();
  takeResults();
}

void Backend::readBack(Result& result) {
  if (result.host.bytes() > 0) commands_->copy(result.device, result.host, result.host.bytes());
}

void Backend::takeResults() {
  if (hasSign()) {
    throwIfFailed(crossingsStatus_.mapped<CrossingsStatus>().front());
    doubtfulShare_ = double(doubtful_.mapped<uint32_t>().front()) / double(grid_->sampleCount());
  }
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
