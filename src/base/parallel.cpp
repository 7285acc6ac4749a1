#include "base/parallel.h"

#include <raymap/threads.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <climits>
#include <new>
#include <thread>
#include <utility>

#include "base/require.h"

#if defined(__unix__) || defined(__APPLE__)
#include <pthread.h>
#define RAYMAP_MAY_FORK
#endif

#ifdef RAYMAP_THREAD_SANITIZER
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace raymap {

namespace {

/// Declares the order of a parallel loop to ThreadSanitizer, which cannot see into an uninstrumented TBB. All
/// code before the loop happens before each part, and each part before all code after the loop. Races between
/// parts are still detected.
class LoopOrder {
#ifdef RAYMAP_THREAD_SANITIZER
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

/// Whether this thread works for a call of `withThreads`.
thread_local bool isLimited = false;

/// Sets `isLimited` while it lives.
class Limited {
 public:
  Limited() = default;
  ~Limited() { isLimited = before_; }
  Limited(const Limited&) = delete;
  Limited& operator=(const Limited&) = delete;

 private:
  bool before_ = std::exchange(isLimited, true);
};

/// Returns how many threads a call gets that asks for this many, 0 = all: at most as many as the machine has,
/// and as the program around the library allows. TBB prints a warning when asked for more.
int threadsFor(int asked) {
  const auto allowed = static_cast<int>(std::min<size_t>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism), INT_MAX));
  if (asked == 0 && !isLimited) asked = defaultThreads();
  if (asked == 0) asked = tbb::this_task_arena::max_concurrency();
  return std::min({asked, allowed, tbb::info::default_concurrency()});
}

/// Whether this process was forked while TBB had threads, which are gone here with the locks that they held.
/// Each loop then runs on the thread that calls, without TBB.
bool isAlone = false;

/// Ends TBB's threads before the process is forked. They start again when they are needed. Where another
/// thread lives that has used TBB, they cannot be ended, and the child is alone.
void expectForks() {
#ifdef RAYMAP_MAY_FORK
  thread_local bool areThreadsEnded = true;  // Both handlers run on the thread that forks.
  [[maybe_unused]] static const int isExpected = pthread_atfork(
      [] {
        if (isAlone) return;
        tbb::task_scheduler_handle threads{tbb::attach{}};
        areThreadsEnded = tbb::finalize(threads, std::nothrow);
      },
      nullptr, [] { isAlone = isAlone || !areThreadsEnded; });
#endif
}

}  // namespace

void parallelFor(size_t count, size_t grain, FunctionView<size_t, size_t> work) {
  if (count == 0) return;
  if (count <= grain) return work(0, count);  // One part needs no threads.
  const auto visit = [&](size_t begin, size_t end) {
    const Limited limited;
    for (; begin < end; begin += grain) work(begin, std::min(begin + grain, end));
  };
  if (isAlone) return visit(0, count);
  withCallersThreads([&] {
    [[maybe_unused]] LoopOrder order;
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, count, grain),
        [&](const tbb::blocked_range<size_t>& range) {
          [[maybe_unused]] const LoopOrder::Part part(order);
          visit(range.begin(), range.end());
        },
        tbb::simple_partitioner());
  });
}

void withCallersThreads(FunctionView<> work) {
  if (isLimited)
    work();
  else
    withThreads(0, work);
}

void withThreads(int threads, FunctionView<> work) {
  require(threads >= 0, "the number of threads must not be negative");
  const auto workLimited = [&] {
    const Limited limited;
    work();
  };
  if (isAlone) return workLimited();
  expectForks();
  tbb::task_arena arena(threadsFor(threads));
  arena.execute(workLimited);
}

void startThreads() {
  const size_t all = parallelThreads();
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
  std::atomic<size_t> started{0};
  parallelFor(all, 1, [&](size_t, size_t) {  // TBB starts a thread for each part that none is free for.
    for (++started; started < all && std::chrono::steady_clock::now() < end;) std::this_thread::yield();
  });
}

size_t parallelThreads() {
  if (isAlone) return 1;
  return static_cast<size_t>(isLimited ? tbb::this_task_arena::max_concurrency() : threadsFor(0));
}

}  // namespace raymap
