#include "api/device_test.h"

#include <raymap/error.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "api/device_record.h"
#include "base/stopwatch.h"
#include "method/gpu_plug_in.h"

namespace raymap {

namespace {

/// A test on a thread of its own, so that a driver that hangs does not stop the caller. Both threads share
/// it: one of them may outlive the other's interest.
class WatchedTest {
 public:
  enum class End { Complete, Stopped, Hangs };

  explicit WatchedTest(const TestMark& mark) : mark_(&mark) {}

  static End run(const std::shared_ptr<WatchedTest>& test, size_t number, const std::string& name,
                 const ProgressCallback& progress, const Hangs& hangs) {
    std::thread([test, number] { test->work(number); }).detach();
    std::unique_lock lock(test->mutex_);
    while (!test->isOver_) {
      test->change_.wait_for(lock, std::chrono::milliseconds(20));
      if (!test->isOver_ && hangs(test->check_, test->checkTime_.seconds())) {
        test->mark_ = nullptr;
        return End::Hangs;
      }
      const double done = test->done_;
      lock.unlock();
      const bool goesOn = !progress || progress(name, done);
      lock.lock();
      if (!goesOn) test->isStopped_ = true;
    }
    if (test->error_) std::rethrow_exception(test->error_);
    return test->isStopped_ ? End::Stopped : End::Complete;
  }

  std::vector<DeviceCheck> checks() {
    const std::lock_guard lock(mutex_);
    return checks_;
  }
  std::string check() {
    const std::lock_guard lock(mutex_);
    return check_;
  }

 private:
  void work(size_t number) {
    std::exception_ptr error;
    try {
      gpuPlugIn()->test(number, {.begin = [this](const char* name, double done) { return begin(name, done); },
                                 .found = [this](DeviceCheck check) { add(std::move(check)); }});
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    error_ = error;
    isOver_ = true;
    change_.notify_one();
  }

  bool begin(const char* name, double done) {
    const std::lock_guard lock(mutex_);
    if (!mark_ || isStopped_) return false;
    mark_->write(name);
    check_ = name;
    done_ = done;
    checkTime_.restart();
    return true;
  }
  void add(DeviceCheck check) {
    const std::lock_guard lock(mutex_);
    checks_.push_back(std::move(check));
  }

  std::mutex mutex_;
  std::condition_variable change_;
  const TestMark* mark_;  ///< Null once nobody waits for the test any more.
  std::string check_ = "start";
  double done_ = 0.0;
  Stopwatch checkTime_;
  bool isStopped_ = false, isOver_ = false;
  std::exception_ptr error_;
  std::vector<DeviceCheck> checks_;
};

std::string problemIn(const std::vector<DeviceCheck>& checks) {
  for (const DeviceCheck& check : checks)
    if (!check.difference.empty()) return check.name + ": " + check.difference;
  return {};
}

std::string nameOf(const DeviceInfo& device) {
  return device.id + " (" + device.name + ", driver " + device.driver + ")";
}

DeviceTest runTest(const TestMark& mark, const DeviceInfo& device, size_t number,
                   const ProgressCallback& progress, const Hangs& hangs) {
  const Stopwatch stopwatch;
  DeviceTest result{.device = device};
  const auto test = std::make_shared<WatchedTest>(mark);
  try {
    const auto end = WatchedTest::run(test, number, "test of " + device.id, progress, hangs);
    if (end == WatchedTest::End::Stopped)
      throw Error(ErrorCode::Cancelled, "the test of " + device.id + " was cancelled");
    result.hangs = end == WatchedTest::End::Hangs;
    result.checks = test->checks();
    result.problem = problemIn(result.checks);
    if (result.hangs && result.problem.empty())
      result.problem =
          test->check() + ": did not end within " + std::to_string(static_cast<int>(kCheckSeconds)) + " s";
  } catch (const Error& error) {
    if (error.code() == ErrorCode::Cancelled) throw;
    result.checks = test->checks();
    result.problem = test->check() + ": " + error.what();
  }
  result.milliseconds = stopwatch.milliseconds();
  return result;
}

DeviceTest testAndRecord(const TestMark& mark, const DeviceInfo& device, size_t number,
                         const ProgressCallback& progress, const Hangs& hangs) {
  DeviceTest result = runTest(mark, device, number, progress, hangs);
  const bool isPassed = result.problem.empty();
  result.device.test = isPassed ? DeviceTestState::Passed : DeviceTestState::Failed;
  result.device.testProblem = result.problem;
  writeRecord(device, {result.device.test, result.problem});
  return result;
}

}  // namespace

DeviceTest testGpu(const DeviceInfo& device, size_t number, const ProgressCallback& progress,
                   const Hangs& hangs) {
  const TestMark mark(device, kOtherTestSeconds);
  return testAndRecord(mark, device, number, progress, hangs);
}

DeviceTestState testOnce(const DeviceInfo& device, size_t number, const ProgressCallback& progress) {
  const DeviceTestState before = readRecord(device).state;
  if (before != DeviceTestState::Untested && before != DeviceTestState::Running) return before;
  const TestMark mark(device, kOtherTestSeconds);
  const DeviceTestState meanwhile = readResult(device).state;
  if (meanwhile != DeviceTestState::Untested) return meanwhile;
  return testAndRecord(mark, device, number, progress, takesTooLong).device.test;
}

std::string reasonAgainst(const DeviceInfo& device) {
  const DeviceRecord record = readRecord(device);
  switch (record.state) {
    case DeviceTestState::Failed:
      return nameOf(device) + " failed its test: " + record.problem;
    case DeviceTestState::Unfinished:
      return "the test of " + nameOf(device) + " did not end, in the check " + record.problem +
             ": the driver crashed, or the process was killed";
    default:
      return {};
  }
}

}  // namespace raymap
