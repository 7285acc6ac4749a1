#include <raymap/error.h>
#include <raymap/generate.h>

#include <chrono>

#include "api/devices.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "cpu/backend.h"
#include "mesh/packed_mesh.h"
#include "method/check_options.h"
#include "method/thickness.h"

namespace raymap {

namespace {

size_t fieldBytes(const Field& field) {
  return field.distance.capacityBytes() + field.triangle.capacityBytes() + field.winding.capacityBytes() +
         field.confidence.capacityBytes();
}

/// Runs the pipeline. A copy of the caller's mesh holds `meshBytes` bytes; 0 if there is none.
Stats generateOnCpu(cpu::Backend& backend, const Job& job, size_t meshBytes) {
  const size_t held = meshBytes + backend.bytes() + fieldBytes(job.field);
  const size_t limit = job.options.memoryLimit ? job.options.memoryLimit : availableMemory() + held;
  checkFieldMemory(meshBytes + cpu::Backend::bytesNeeded(job.mesh, job.grid, job.options), limit);
  withThreads(job.options.threads, [&] {
    backend.take(job);
    runPipeline(backend);
  });
  Stats stats;
  stats.device = "cpu";
  for (const Progress::Time& time : job.progress.times())
    stats.stages.push_back({time.stage, time.milliseconds});
  stats.bytes = meshBytes + backend.bytes() + fieldBytes(job.field);
  describeMesh(backend, job.grid, stats);
  return stats;
}

}  // namespace

struct Generator::Impl {
  cpu::Backend cpu;
  ChosenDevice device;
  MeshPacker packer;

  PackedMesh pack(const MeshView& view, const Options& options) {
    if (options.memoryLimit) checkFieldMemory(MeshPacker::bytesNeeded(view), options.memoryLimit);
    const PackedMesh mesh = packer.pack(view);
    validate(mesh);
    return mesh;
  }
};

Generator::Generator() : impl_(std::make_unique<Impl>()) {}
Generator::~Generator() = default;
Generator::Generator(Generator&&) noexcept = default;
Generator& Generator::operator=(Generator&&) noexcept = default;

Stats Generator::generate(const MeshView& view, const Grid& grid, const Options& asked, Field& field) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  Stats stats;
  try {
    checkOptions(grid, asked);
    const Options options = asked.thickness > 0.0 ? withoutThickness(asked, grid) : asked;
    const PackedMesh mesh = impl_->pack(view, options);
    const auto onGpu = [&](GpuDevice& gpu, size_t number) {
      Progress progress(options.progress);
      withThreads(options.threads, [&] { gpu.generate({mesh, grid, options, progress, field}, stats); });
      stats.device = "vulkan:" + std::to_string(number);
    };
    if (!impl_->device.run(options.device, options.warn, options.progress, onGpu)) {
      Progress progress(options.progress);
      stats = generateOnCpu(impl_->cpu, {mesh, grid, options, progress, field}, impl_->packer.bytes());
    }
    if (asked.thickness > 0.0) thicken(asked, field);
  } catch (...) {
    field = {};
    throw;
  }
  stats.totalMilliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return stats;
}

Generated Generator::generate(const MeshView& mesh, const Grid& grid, const Options& options) {
  Generated result;
  result.stats = generate(mesh, grid, options, result.field);
  return result;
}

Generated generate(const MeshView& mesh, const Grid& grid, const Options& options) {
  return Generator().generate(mesh, grid, options);
}

}  // namespace raymap
