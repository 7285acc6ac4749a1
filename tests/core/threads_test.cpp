// How many threads a call uses, and what that changes for the program around it.

#include <gtest/gtest.h>
#include <raymap/raymap.h>
#include <raymap/threads.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <future>
#include <mutex>
#include <set>
#include <thread>

#include "any_threads.h"
#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "environment.h"
#include "shapes.h"

namespace raymap {
namespace {

using tbb::global_control;

size_t allowed() {
  return global_control::active_value(global_control::max_allowed_parallelism);
}

size_t machineThreads() {
  return size_t(tbb::info::default_concurrency());
}

/// Sets the default number of threads while it lives.
class ScopedDefault {
 public:
  explicit ScopedDefault(int threads) { setDefaultThreads(threads); }
  ~ScopedDefault() { setDefaultThreads(0); }
  ScopedDefault(const ScopedDefault&) = delete;
  ScopedDefault& operator=(const ScopedDefault&) = delete;
};

size_t threadsIn(int asked) {
  size_t threads = 0;
  withThreads(asked, [&] { threads = parallelThreads(); });
  return threads;
}

/// Returns the threads on which a loop runs.
std::set<std::thread::id> threadsOfALoop() {
  std::mutex mutex;
  std::set<std::thread::id> ids;
  parallelFor(1000, 1, [&](size_t, size_t) {
    const std::lock_guard lock(mutex);
    ids.insert(std::this_thread::get_id());
  });
  return ids;
}

std::string messageFor(const char* threads) {
  const ScopedVariable variable("RAYMAP_THREADS", threads);
  try {
    return std::to_string(defaultThreads());
  } catch (const Error& error) {
    return (error.code() == ErrorCode::Usage ? "usage: " : "") + std::string(error.what());
  }
}

TEST(Threads, LimitsTheCallAndNotTheProcess) {
  const size_t before = allowed();
  for (const int threads : {0, 1, 2, 1000}) {
    size_t meanwhile = 0;
    withThreads(threads, [&] { meanwhile = std::async(std::launch::async, allowed).get(); });
    EXPECT_EQ(meanwhile, before) << threads;
  }
}

TEST(Threads, GivesEachOfSeveralCallsItsNumber) {
  size_t outer = 0, other = 0;
  withThreads(1, [&] {
    other = std::async(std::launch::async, [] { return threadsIn(2); }).get();
    outer = parallelThreads();
  });
  EXPECT_EQ(outer, 1u);
  EXPECT_EQ(other, std::min<size_t>(2, machineThreads()));
}

TEST(Threads, TakesNoMoreThanTheMachineHas) {
  EXPECT_EQ(threadsIn(1), 1u);
  EXPECT_EQ(threadsIn(0), machineThreads());
  EXPECT_EQ(threadsIn(100000), machineThreads());
  const Mesh mesh = shapes::sphere(1.0, 3);
  expectSameForAnyThreads(mesh, fitGrid(mesh, {.resolution = 20}), {}, {2, 100000, 0});
}

TEST(Threads, TakesNoMoreThanTheProgramAllows) {
  const global_control control(global_control::max_allowed_parallelism, 1);
  testing::internal::CaptureStderr();
  EXPECT_EQ(threadsIn(2), 1u);
  EXPECT_EQ(threadsIn(0), 1u);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Threads, TakesNoMoreThanTheArenaItIsCalledIn) {
  tbb::task_arena(1).execute([] { EXPECT_EQ(threadsIn(0), 1u); });
}

TEST(Threads, HasADefault) {
  EXPECT_EQ(defaultThreads(), 0);
  {
    const ScopedDefault one(1);
    EXPECT_EQ(defaultThreads(), 1);
    EXPECT_EQ(parallelThreads(), 1u);
    EXPECT_EQ(threadsIn(0), 1u);
    EXPECT_EQ(threadsIn(2), std::min<size_t>(2, machineThreads()));
    EXPECT_EQ(threadsOfALoop(), std::set{std::this_thread::get_id()});
    std::set<std::thread::id> sorting;
    std::mutex mutex;
    std::vector<int> numbers(10000);
    for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = int(i * 7919 % numbers.size());
    parallelSort(numbers.begin(), numbers.end(), [&](int a, int b) {
      const std::lock_guard lock(mutex);
      sorting.insert(std::this_thread::get_id());
      return a < b;
    });
    EXPECT_EQ(sorting, std::set{std::this_thread::get_id()});
    EXPECT_TRUE(std::ranges::is_sorted(numbers));
  }
  EXPECT_EQ(threadsIn(0), machineThreads());
  EXPECT_THROW(setDefaultThreads(-1), Error);
  EXPECT_EQ(defaultThreads(), 0);
}

TEST(Threads, KeepsTheNumberOfTheCallAround) {
  const ScopedDefault most(1000);
  withThreads(1, [] {
    EXPECT_EQ(parallelThreads(), 1u);
    EXPECT_EQ(threadsIn(0), 1u);
    EXPECT_EQ(threadsOfALoop(), std::set{std::this_thread::get_id()});
  });
  const ScopedDefault one(1);
  withThreads(2, [] {
    EXPECT_EQ(threadsIn(0), std::min<size_t>(2, machineThreads()));
    parallelFor(100, 1,
                [](size_t, size_t) { EXPECT_EQ(parallelThreads(), std::min<size_t>(2, machineThreads())); });
  });
}

TEST(Threads, MayBeCalledByACallback) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  const Generated expected = generate(mesh, grid, {}, {.device = "cpu"});
  for (const int threads : {0, 1, 2}) {
    size_t calls = 0;
    const auto callBack = [&](std::string_view, double) {
      ++calls;
      EXPECT_TRUE(
          sameBits(generate(mesh, grid, {}, {.device = "cpu"}).field.distance, expected.field.distance));
      EXPECT_EQ(diagnose(mesh).triangles, mesh.triangles.size());
      return true;
    };
    const Generated made =
        generate(mesh, grid, {}, {.device = "cpu", .threads = threads, .progress = callBack});
    EXPECT_TRUE(sameBits(made.field.distance, expected.field.distance));
    EXPECT_GT(calls, 3u);
  }
}

// The variable is read once, so each value needs a process.
TEST(ThreadsDeathTest, ReadsTheVariable) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const auto expect = [](const char* value, const std::string& message) {
    EXPECT_EXIT((std::fputs(messageFor(value).c_str(), stderr), std::exit(0)), testing::ExitedWithCode(0),
                testing::MatchesRegex(message))
        << value;
  };
  expect("3", "3");
  expect("0", "0");
  expect("", "0");
  const auto wrong = [](const std::string& value) {
    return "usage: the environment variable RAYMAP_THREADS is '" + value +
           "'; it must be a number of threads, or 0 for all";
  };
  for (const char* value : {"many", "-1", "1.5", "2 ", "99999999999"}) expect(value, wrong(value));
}

}  // namespace
}  // namespace raymap
