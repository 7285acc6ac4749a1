#include "cpu/run_on_cpu.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "method/stage_times.h"

namespace raymap::cpu {

Stats runOnCpu(Backend& backend, const Job& job, size_t meshBytes) {
  backend.take(job, meshBytes);
  checkFieldMemory(meshBytes + Backend::bytesNeeded(job.mesh, job.grid, job.options), backend.mostBytes());
  withThreads(job.machine.threads, [&] { runPipeline(backend); });
  Stats stats;
  stats.device = "cpu";
  addStages(job.progress, stats);
  stats.bytes = backend.bytes();
  describeMesh(backend, job.grid, stats);
  return stats;
}

}  // namespace raymap::cpu
