#include "base/progress.h"

#include <gtest/gtest.h>
#include <raymap/error.h>

#include <atomic>
#include <future>
#include <thread>

namespace raymap {
namespace {

TEST(Progress, NamesStagesAndNeverGoesBack) {
  std::vector<std::pair<std::string, double>> calls;
  Progress progress([&](std::string_view stage, double done) {
    calls.emplace_back(stage, done);
    return true;
  });
  progress.stage("first", [&] {
    progress.report(0.5);
    progress.report(0.25);
    progress.part(0.6, 0.8);
    progress.report(0.5);
    progress.poll();
    progress.part(0.0, 0.5);
    progress.report(1.0);
  });
  progress.stage("second", [&] { progress.report(0.1); });
  using Calls = std::vector<std::pair<std::string, double>>;
  EXPECT_EQ(calls, (Calls{{"first", 0.0},
                          {"first", 0.5},
                          {"first", 0.5},
                          {"first", 0.6 + 0.2 * 0.5},
                          {"first", 0.6 + 0.2 * 0.5},
                          {"first", 0.6 + 0.2 * 0.5},
                          {"second", 0.0},
                          {"second", 0.1}}));
  ASSERT_EQ(progress.times().size(), 2u);
  EXPECT_EQ(progress.times()[0].stage, "first");
}

TEST(Progress, StopsEveryThreadAfterFalse) {
  for (int round = 0; round < 100; ++round) {
    std::atomic<int> reports{0}, calls{0}, stopped{0};
    Progress progress([&](std::string_view, double) {
      if (++calls > 1) return false;
      for (const int now = reports; reports < now + 20;) std::this_thread::yield();  // Reports of the others.
      return false;
    });
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        try {
          for (;; ++reports) progress.report(0.5);
        } catch (const Error& error) {
          stopped += error.code() == ErrorCode::Cancelled ? 1 : 0;
        }
      });
    for (std::thread& thread : threads) thread.join();
    ASSERT_EQ(calls, 1) << "the callback was called after it had returned false";
    EXPECT_EQ(stopped, 4);
  }
}

TEST(Progress, SkipsReportsWhileTheCallbackRuns) {
  std::atomic<int> calls{0};
  Progress progress([&](std::string_view, double) {
    if (++calls == 1) std::async(std::launch::async, [&] { progress.report(0.7); }).get();
    return true;
  });
  progress.report(0.5);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace raymap
