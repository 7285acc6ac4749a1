#include "runner.h"

#include "backend.h"
#include "memory.h"
#include "pipeline.h"

namespace raymap::vulkan {

struct Runner::Impl {
  explicit Impl(size_t index) : device({.index = index}), backend(device) {}
  Device device;
  Backend backend;
};

Runner::Runner(size_t index) : impl_(std::make_unique<Impl>(index)) {}
Runner::~Runner() = default;

void Runner::run(const Mesh& mesh, const Grid& grid, const Options& options, Field& field, Stats& stats) {
  Backend& backend = impl_->backend;
  if (options.memoryLimit != 0)
    checkFieldMemory(Backend::bytesNeeded(mesh, grid, options), options.memoryLimit, " on the device");
  Progress progress(options, stats);
  runPipeline(backend, mesh, grid, options, progress, field);
  stats.stages = backend.stages();
  stats.bytes = impl_->device.heldMemory();
  stats.doubtfulShare = backend.doubtfulShare();
  backend.faceSides().report(stats);
  backend.patch().report(grid, stats);
}

}  // namespace raymap::vulkan
