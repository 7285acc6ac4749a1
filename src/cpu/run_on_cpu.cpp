#include "cpu/run_on_cpu.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "method/stage_times.h"

namespace raymap::cpu {

Stats runOnCpu(Backend& backend, const Job& job, size_t meshBytes, std::optional<Frames> frames) {
  backend.take(job, meshBytes, frames);
  checkFieldMemory(meshBytes + backend.bytesNeeded(), backend.mostBytes());
  withThreads(job.machine.threads, [&] { runPipeline(backend); });
  Stats stats;
  stats.device = "cpu";
  addStages(job.progress, stats);
  stats.bytes = backend.bytes();
  describeMesh(backend, job.grid, stats);
  return stats;
}

}  // namespace raymap::cpu
