#include "runner.h"

#include <raymap/error.h>

#include "backend.h"
#include "pipeline.h"

namespace raymap::vulkan {

namespace {

std::string mebibytes(size_t bytes) {
  return std::to_string((bytes + (size_t{1} << 20) - 1) >> 20) + " MiB";
}

}  // namespace

struct Runner::Impl {
  explicit Impl(size_t index) : device({.index = index}), backend(device) {}
  Device device;
  Backend backend;
};

Runner::Runner(size_t index) : impl_(std::make_unique<Impl>(index)) {}
Runner::~Runner() = default;

void Runner::run(const Mesh& mesh, const Grid& grid, const Options& options, Field& field, Stats& stats) {
  Backend& backend = impl_->backend;
  const size_t needed = Backend::bytesNeeded(mesh, grid, options);
  if (options.memoryLimit != 0 && needed > options.memoryLimit)
    throw Error(ErrorCode::Memory, "the field needs " + mebibytes(needed) + " on the device, but only " +
                                       mebibytes(options.memoryLimit) +
                                       " may be used; use a lower resolution or a higher limit");
  Progress progress(options, stats);
  runPipeline(backend, mesh, grid, options, progress, field);
  stats.stages = backend.stages();
  stats.bytes = impl_->device.heldMemory();
  stats.doubtfulShare = backend.doubtfulShare();
}

}  // namespace raymap::vulkan
