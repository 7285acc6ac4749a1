#include "base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <optional>

#ifdef __SANITIZE_THREAD__
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace raymap {

namespace {

/// Declares the order of a parallel loop to ThreadSanitizer, which cannot see into an uninstrumented TBB. All
/// code before the loop happens before each part, and each part before all code after the loop. Races between
/// parts are still detected.
class LoopOrder {
#ifdef __SANITIZE_THREAD__
 public:
  LoopOrder() {
    __tsan_release(&start_);
  }
  ~LoopOrder() {
    __tsan_acquire(&end_);
  }

  struct Part {
    explicit Part(LoopOrder& loop) : order(loop) { __tsan_acquire(&order.start_); }
    ~Part() { __tsan_release(&order.end_); }
    LoopOrder& order;
  };

 private:
  char start_ = 0, end_ = 0;
#else
 public:
  struct Part {
    explicit Part(LoopOrder&) {}
  };
#endif
};

}  // namespace

void parallelFor(size_t count, size_t grain, FunctionView<size_t, size_t> work) {
  if (count == 0) return;
  [[maybe_unused]] LoopOrder order;
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, count, grain),
      [&](const tbb::blocked_range<size_t>& range) {
        [[maybe_unused]] const LoopOrder::Part part(order);
        for (size_t begin = range.begin(); begin < range.end(); begin += grain)
          work(begin, std::min(begin + grain, range.end()));
      },
      tbb::simple_partitioner());
}

void withThreads(int threads, FunctionView<> work) {
  // Without a limit of its own, TBB prints a warning when asked for more threads than there are cores.
  std::optional<tbb::global_control> limit;
  if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] { work(); });
}

size_t parallelThreads() {
  return static_cast<size_t>(tbb::this_task_arena::max_concurrency());
}

}  // namespace raymap
