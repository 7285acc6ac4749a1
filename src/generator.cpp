#include <raymap/error.h>
#include <raymap/generate.h>

#include <cmath>
#include <string>

#include "cpu/backend.h"
#include "cpu/parallel.h"
#include "memory.h"
#include "pipeline.h"

namespace raymap {

namespace {

void checkOptions(const Grid& grid, const Options& options) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorCode::Usage, what);
  };
  require(grid.dims.x > 0 && grid.dims.y > 0 && grid.dims.z > 0, "the grid has no samples");
  require(grid.spacing > 0.0 && std::isfinite(grid.spacing), "the grid's spacing must be positive");
  require(options.band >= 0.0, "the band must not be negative");
  require(options.passes >= 0, "the number of passes must not be negative");
  require(options.threshold >= 0.0, "the threshold must not be negative");
  require(options.threads >= 0, "the number of threads must not be negative");
  require(!options.triangleIds || options.distance != DistanceMode::Raster,
          "the raster distance knows no closest triangles; use another distance");
  require(grid.sampleCount() < kNoTriangle,
          "the grid has " + std::to_string(grid.sampleCount()) +
              " samples; at most 4294967294 can be numbered, use a lower resolution");
}

void checkMemory(size_t needed, size_t limit) {
  const auto mebibytes = [](size_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB"; };
  if (needed > limit)
    throw Error(ErrorCode::Memory, "the field needs " + mebibytes(needed) + ", but only " + mebibytes(limit) +
                                       " may be used; use a lower resolution or a higher limit");
}

size_t fieldBytes(const Field& field) {
  return field.distance.capacityBytes() + field.triangle.capacityBytes() + field.winding.capacityBytes() +
         field.confidence.capacityBytes();
}

}  // namespace

struct Generator::Impl {
  CpuBackend backend;
  Stats stats;
};

Generator::Generator() : impl_(std::make_unique<Impl>()) {}
Generator::~Generator() = default;
Generator::Generator(Generator&&) noexcept = default;
Generator& Generator::operator=(Generator&&) noexcept = default;

const Stats& Generator::stats() const {
  return impl_->stats;
}

void Generator::generate(const Mesh& mesh, const Grid& grid, const Options& options, Field& field) {
  CpuBackend& backend = impl_->backend;
  Stats& stats = impl_->stats;
  try {
    checkOptions(grid, options);
    validate(mesh);
    const size_t held = backend.bytes() + fieldBytes(field);
    const size_t limit = options.memoryLimit ? options.memoryLimit : availableMemory() + held;
    checkMemory(CpuBackend::bytesNeeded(mesh, grid, options), limit);
    stats = {};
    Progress progress(options, stats);
    withThreads(options.threads, [&] { runPipeline(backend, mesh, grid, options, progress, field); });
  } catch (...) {
    field = {};
    throw;
  }
  for (const Stats::Stage& stage : stats.stages) stats.totalMilliseconds += stage.milliseconds;
  stats.bytes = backend.bytes() + fieldBytes(field);
  stats.doubtfulShare = backend.doubtfulShare();
}

Field generate(const Mesh& mesh, const Grid& grid, const Options& options) {
  Field field;
  Generator().generate(mesh, grid, options, field);
  return field;
}

}  // namespace raymap
