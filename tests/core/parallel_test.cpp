#include "base/parallel.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <stdexcept>
#include <thread>

#include "base/parallel_sort.h"

namespace raymap {
namespace {

TEST(Parallel, VisitsEachElementOnce) {
  for (const size_t count : {size_t{0}, size_t{1}, size_t{999}, size_t{1000}})
    for (const size_t grain : {size_t{1}, size_t{7}, size_t{1000}}) {
      std::vector<int> visits(count, 0);
      parallelFor(count, grain, [&](size_t begin, size_t end) {
        EXPECT_LE(end - begin, grain);
        for (size_t k = begin; k < end; ++k) ++visits[k];
      });
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " by " << grain;
    }
}

TEST(Parallel, HandsOutEachNumberOnce) {
  std::vector<int> visits(1000, 0);
  parallelWorkers(visits.size(), [&](auto& next) {
    for (size_t k = next(); k < visits.size(); k = next()) ++visits[k];
  });
  EXPECT_EQ(visits, std::vector<int>(visits.size(), 1));
}

TEST(Parallel, SelectsInOrder) {
  const std::vector<uint32_t> selected = parallelSelect(200000, [](uint32_t k) { return k % 3 == 0; });
  ASSERT_EQ(selected.size(), 66667u);
  for (uint32_t k = 0; k < selected.size(); ++k) ASSERT_EQ(selected[k], 3 * k);
}

#ifndef RAYMAP_THREAD_SANITIZER  // ThreadSanitizer ends a process that starts threads after a fork.
size_t sumTo(size_t count) {
  std::atomic<size_t> sum{0};
  parallelFor(count, 1, [&](size_t begin, size_t) { sum += begin; });
  return sum.load();
}

/// Forks the process this many times, always right after a loop, and expects `work` to succeed in each child.
/// A lock that a thread held when the process was forked would hold up one child in some hundred for ever.
void expectInForks(int forks, FunctionView<bool&> work) {
  for (int k = 0; k < forks; ++k) {
    ASSERT_EQ(sumTo(200), 19900u);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      alarm(30);
      bool isRight = false;
      work(isRight);
      _exit(isRight ? 0 : 1);
    }
    int status = 1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0) << "after " << k << " forks";
  }
}

TEST(Parallel, WorksInForkedProcesses) {
  expectInForks(300, [](bool& isRight) { isRight = sumTo(200) == 19900; });
}

/// TBB's threads cannot be ended while another thread lives that has used them.
TEST(Parallel, WorksAloneInProcessesForkedBesideThreads) {
  std::promise<void> end, used;
  std::thread other([&] {
    sumTo(200);
    used.set_value();
    end.get_future().wait();
  });
  used.get_future().wait();
  expectInForks(300, [](bool& isRight) {
    std::vector<int> numbers = {3, 1, 2};
    parallelSort(numbers.begin(), numbers.end());
    size_t threads = 0;
    withThreads(2, [&] { threads = parallelThreads(); });
    isRight =
        sumTo(200) == 19900 && threads == 1 && parallelThreads() == 1 && numbers == std::vector<int>{1, 2, 3};
    // The child of such a child does not wait for the threads either.
    const pid_t child = fork();
    if (child == 0) _exit(sumTo(200) == 19900 ? 0 : 1);
    int status = 1;
    isRight = isRight && waitpid(child, &status, 0) == child && status == 0;
  });
  end.set_value();
  other.join();
}
#endif

TEST(Parallel, PassesErrorsOn) {
  EXPECT_THROW(parallelFor(100, 1,
                           [](size_t begin, size_t) {
                             if (begin == 42) throw std::runtime_error("42");
                           }),
               std::runtime_error);
}

#ifdef RAYMAP_THREAD_SANITIZER

/// Two parts of a loop, each on a thread of its own, write to the same places. The count orders nothing. One
/// of them begins at the end, for the sanitizer may miss two accesses at the very same time.
void race() {
  std::vector<int> written(1000);
  std::atomic<int> parts{0};
  parallelFor(2, 1, [&](size_t begin, size_t) {
    parts.fetch_add(1, std::memory_order_relaxed);
    while (parts.load(std::memory_order_relaxed) < 2) std::this_thread::yield();
    for (size_t i = 0; i < written.size(); ++i) written[begin == 0 ? i : written.size() - 1 - i] = int(begin);
  });
  std::fprintf(stderr, "no race in %d\n", written[0]);
  std::exit(0);
}

// The suppressions for TBB must not hide what a loop does itself.
TEST(ParallelDeathTest, ThreadSanitizerSeesRacesBetweenParts) {
  if (parallelThreads() < 2) GTEST_SKIP() << "needs two processors";
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(race(), testing::ExitedWithCode(66), "data race");
}

#endif

}  // namespace
}  // namespace raymap
