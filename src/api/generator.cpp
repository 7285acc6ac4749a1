#include <raymap/error.h>
#include <raymap/generate.h>

#include <chrono>

#include "api/devices.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "cpu/backend.h"
#include "method/check_options.h"
#include "method/thickness.h"

namespace raymap {

namespace {

size_t fieldBytes(const Field& field) {
  return field.distance.capacityBytes() + field.triangle.capacityBytes() + field.winding.capacityBytes() +
         field.confidence.capacityBytes();
}

Stats generateOnCpu(cpu::Backend& backend, const Job& job) {
  const size_t held = backend.bytes() + fieldBytes(job.field);
  const size_t limit = job.options.memoryLimit ? job.options.memoryLimit : availableMemory() + held;
  checkFieldMemory(cpu::Backend::bytesNeeded(job.mesh, job.grid, job.options), limit);
  backend.take(job);
  runPipeline(backend);
  Stats stats;
  stats.device = "cpu";
  for (const Progress::Time& time : job.progress.times())
    stats.stages.push_back({time.stage, time.milliseconds});
  stats.bytes = backend.bytes() + fieldBytes(job.field);
  describeMesh(backend, job.grid, stats);
  return stats;
}

}  // namespace

struct Generator::Impl {
  cpu::Backend cpu;
  ChosenDevice device;

  Stats run(const Mesh& mesh, const Grid& grid, const Options& options, Field& field) {
    Stats stats;
    const auto onGpu = [&](GpuDevice& gpu, size_t index) {
      Progress progress(options.progress);
      gpu.generate({mesh, grid, options, progress, field}, stats);
      stats.device = "vulkan:" + std::to_string(index);
    };
    const auto onCpu = [&] {
      Progress progress(options.progress);
      stats = generateOnCpu(cpu, {mesh, grid, options, progress, field});
    };
    withThreads(options.threads, [&] { device.run(options.device, options.warn, onGpu, onCpu); });
    return stats;
  }
};

Generator::Generator() : impl_(std::make_unique<Impl>()) {}
Generator::~Generator() = default;
Generator::Generator(Generator&&) noexcept = default;
Generator& Generator::operator=(Generator&&) noexcept = default;

Stats Generator::generate(const Mesh& mesh, const Grid& grid, const Options& options, Field& field) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  Stats stats;
  try {
    checkOptions(grid, options);
    validate(mesh);
    if (options.thickness > 0.0) {
      stats = impl_->run(mesh, grid, withoutThickness(options, grid), field);
      thicken(options, field);
    } else {
      stats = impl_->run(mesh, grid, options, field);
    }
  } catch (...) {
    field = {};
    throw;
  }
  stats.totalMilliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return stats;
}

Generated generate(const Mesh& mesh, const Grid& grid, const Options& options) {
  Generated result;
  result.stats = Generator().generate(mesh, grid, options, result.field);
  return result;
}

}  // namespace raymap
