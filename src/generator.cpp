#include <raymap/error.h>
#include <raymap/generate.h>

#include <chrono>
#include <string>

#include "check_options.h"
#include "cpu/backend.h"
#include "cpu/parallel.h"
#include "devices.h"
#include "memory.h"
#include "pipeline.h"
#include "thickness.h"
#ifdef RAYMAP_VULKAN
#include "vulkan/runner.h"
#endif

namespace raymap {

namespace {

size_t fieldBytes(const Field& field) {
  return field.distance.capacityBytes() + field.triangle.capacityBytes() + field.winding.capacityBytes() +
         field.confidence.capacityBytes();
}

}  // namespace

struct Generator::Impl {
  CpuBackend cpu;
#ifdef RAYMAP_VULKAN
  std::unique_ptr<vulkan::Runner> gpu;
  size_t gpuIndex = 0;
#endif
  Stats stats;

  void run(const Mesh& mesh, const Grid& grid, const Options& options, Field& field);
  void runOnCpu(const Mesh& mesh, const Grid& grid, const Options& options, Field& field);
  void runOnGpu(size_t index, const Mesh& mesh, const Grid& grid, const Options& options, Field& field);
};

Generator::Generator() : impl_(std::make_unique<Impl>()) {}
Generator::~Generator() = default;
Generator::Generator(Generator&&) noexcept = default;
Generator& Generator::operator=(Generator&&) noexcept = default;

const Stats& Generator::stats() const {
  return impl_->stats;
}

void Generator::Impl::run(const Mesh& mesh, const Grid& grid, const Options& options, Field& field) {
  runOnDevice(
      options.device, options.warn, [&](size_t index) { runOnGpu(index, mesh, grid, options, field); },
      [&] { runOnCpu(mesh, grid, options, field); });
}

void Generator::Impl::runOnCpu(const Mesh& mesh, const Grid& grid, const Options& options, Field& field) {
  const size_t held = cpu.bytes() + fieldBytes(field);
  const size_t limit = options.memoryLimit ? options.memoryLimit : availableMemory() + held;
  checkFieldMemory(CpuBackend::bytesNeeded(mesh, grid, options), limit);
  stats = {};
  Progress progress(options, stats);
  withThreads(options.threads, [&] { runPipeline(cpu, mesh, grid, options, progress, field); });
  stats.device = "cpu";
  stats.bytes = cpu.bytes() + fieldBytes(field);
  stats.doubtfulShare = cpu.doubtfulShare();
  cpu.patch().report(grid, stats);
  cpu.faceSides().report(stats);
}

#ifdef RAYMAP_VULKAN
void Generator::Impl::runOnGpu(size_t index, const Mesh& mesh, const Grid& grid, const Options& options,
                               Field& field) {
  if (!gpu || gpuIndex != index) gpu = std::make_unique<vulkan::Runner>(index);
  gpuIndex = index;
  // Taken out while it runs: what failed is not used again.
  std::unique_ptr<vulkan::Runner> runner = std::move(gpu);
  stats = {};
  withThreads(options.threads, [&] { runner->run(mesh, grid, options, field, stats); });
  stats.device = "vulkan:" + std::to_string(index);
  gpu = std::move(runner);
}
#else
void Generator::Impl::runOnGpu(size_t, const Mesh&, const Grid&, const Options&, Field&) {}
#endif

void Generator::generate(const Mesh& mesh, const Grid& grid, const Options& options, Field& field) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  try {
    checkOptions(grid, options);
    validate(mesh);
    if (options.thickness > 0.0) {
      impl_->run(mesh, grid, withoutThickness(options, grid), field);
      thicken(options, field);
    } else {
      impl_->run(mesh, grid, options, field);
    }
  } catch (...) {
    field = {};
    throw;
  }
  impl_->stats.totalMilliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Field generate(const Mesh& mesh, const Grid& grid, const Options& options) {
  Field field;
  Generator().generate(mesh, grid, options, field);
  return field;
}

}  // namespace raymap
