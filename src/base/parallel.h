#pragma once

// The only file that includes oneTBB.

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>

#ifdef __SANITIZE_THREAD__
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace raymap {

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

/// Calls `work(begin, end)` on parts of [0, count) with at most `grain` elements each. The work must not
/// depend on which thread gets which part.
template <class Work>
void parallelFor(size_t count, size_t grain, Work&& work) {
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

/// Sorts like `std::sort`, on all threads.
template <class Iterator, class... Less>
void parallelSort(Iterator begin, Iterator end, Less... less) {
  tbb::parallel_sort(begin, end, less...);
}

/// Calls `work(next)` on each thread. `next()` hands out the numbers below `count` in order, then always
/// `count`. Use it for work that is faster with state per thread; the results must not depend on that state.
template <class Work>
void parallelWorkers(size_t count, Work&& work) {
  std::atomic<size_t> numbers{0};
  const auto next = [&] { return std::min(numbers++, count); };
  const auto threads = static_cast<size_t>(tbb::this_task_arena::max_concurrency());
  parallelFor(std::min(threads, count), 1, [&](size_t, size_t) { work(next); });
}

/// Runs `work` on at most `threads` threads; 0 = all of the machine's threads.
template <class Work>
void withThreads(int threads, Work&& work) {
  // Without an explicit limit, TBB prints a warning if more threads are requested than there are cores.
  std::optional<tbb::global_control> limit;
  if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute(work);
}

}  // namespace raymap
