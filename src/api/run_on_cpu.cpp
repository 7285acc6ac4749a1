#include "api/run_on_cpu.h"

#include "base/memory.h"
#include "base/parallel.h"

namespace raymap {

namespace {

size_t fieldBytes(const Field& field) {
  return field.distance.capacityBytes() + field.triangle.capacityBytes() + field.winding.capacityBytes() +
         field.confidence.capacityBytes();
}

}  // namespace

Stats runOnCpu(cpu::Backend& backend, const Job& job, size_t meshBytes) {
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

}  // namespace raymap
