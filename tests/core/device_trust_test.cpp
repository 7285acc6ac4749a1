// A GPU is tested before "auto" uses it, and the result is kept.

#include <gtest/gtest.h>
#include <raymap/error.h>

#include <atomic>
#include <fstream>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "api/device_record.h"
#include "api/device_test.h"
#include "api/devices.h"
#include "contains.h"
#include "counting_gpu.h"
#include "error_code.h"
#include "files.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

constexpr size_t kGpu = CountingGpu::kUsable;

class DeviceTrust : public testing::Test {
 protected:
  static DeviceInfo info() { return devices().devices.at(kGpu + 1); }

  /// Returns whether "auto" is the GPU now, for a caller that has not asked before.
  bool isUsed() {
    warning_.clear();
    const auto warn = [this](const Warning& warning) {
      EXPECT_EQ(warning.code, WarningCode::DeviceRefused);
      EXPECT_EQ(warning.fields.device, "vulkan:3");
      warning_ += warning.message;
    };
    return chooseDevice({.warn = warn}) == kGpu;
  }
  /// Expects that "auto" is the CPU and says all this.
  void expectRefused(const std::vector<std::string>& texts) {
    EXPECT_FALSE(isUsed());
    for (const std::string& text : texts) EXPECT_TRUE(contains(warning_, text)) << text << " in " << warning_;
    EXPECT_TRUE(devices().devices[0].chosenByAuto);
  }
  std::vector<fs::path> files() const {
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(folder_.path())) paths.push_back(entry.path());
    return paths;
  }
  fs::path onlyFile() const {
    EXPECT_EQ(files().size(), 1u);
    return files().at(0);
  }
  /// Leaves behind what a test leaves that ended its process.
  void leaveMark(const std::string& check) {
    isUsed();
    const fs::path record = onlyFile();
    std::ofstream(fs::path(record).replace_extension(".running")) << check;
    fs::remove(record);
    CountingGpu::tests = 0;
  }
  static void fail(const DeviceTestReport& report) {
    EXPECT_TRUE(report.begin("scan", 0.0));
    report.found({.name = "scan"});
    EXPECT_TRUE(report.begin("refine", 0.5));
    report.found({.name = "refine", .difference = "number 3 is 1, not 2"});
    report.found({.name = "sign", .difference = "another"});
  }

  CountingGpu gpu_;
  TemporaryFolder folder_;
  ScopedVariable cache_{"RAYMAP_CACHE", folder_.path().string()};
  std::string warning_;
};

TEST_F(DeviceTrust, BeginsWithOneTest) {
  EXPECT_EQ(info().test, DeviceTestState::Untested);
  EXPECT_EQ(deviceToTest(), "vulkan:3");
  for (int time = 0; time < 3; ++time) {
    EXPECT_TRUE(isUsed());
    EXPECT_EQ(warning_, "");
    EXPECT_EQ(CountingGpu::tests, 1);
    EXPECT_EQ(info().test, DeviceTestState::Passed);
    EXPECT_EQ(deviceToTest(), "");
  }
  EXPECT_EQ(onlyFile().extension(), ".txt");
}

TEST_F(DeviceTrust, IsNotAskedOfADeviceThatWasNamed) {
  CountingGpu::onTest = fail;
  for (const char* name : {"vulkan", "vulkan:3"}) EXPECT_EQ(chooseDevice({.device = name}), kGpu);
  EXPECT_EQ(CountingGpu::tests, 0);
  EXPECT_TRUE(files().empty());
}

TEST_F(DeviceTrust, IsRefusedWithTheFirstDifference) {
  CountingGpu::onTest = fail;
  for (int time = 0; time < 2; ++time) {
    expectRefused(
        {"vulkan:3", "Counting GPU", "Counter 1.0", "refine: number 3 is 1, not 2", "test it again"});
    EXPECT_FALSE(contains(warning_, "another"));
    EXPECT_EQ(CountingGpu::tests, 1);
  }
  EXPECT_EQ(info().test, DeviceTestState::Failed);
  EXPECT_EQ(info().testProblem, "refine: number 3 is 1, not 2");
  EXPECT_EQ(deviceToTest(), "");
  EXPECT_EQ(chooseDevice({.device = "vulkan"}), kGpu);
}

TEST_F(DeviceTrust, ComesBackWithATestThatPasses) {
  CountingGpu::onTest = fail;
  const DeviceTest failed = testDevice("vulkan:3");
  EXPECT_EQ(failed.problem, "refine: number 3 is 1, not 2");
  EXPECT_EQ(failed.device.test, DeviceTestState::Failed);
  ASSERT_EQ(failed.checks.size(), 3u);
  EXPECT_EQ(failed.checks[0].difference, "");
  expectRefused({"refine"});
  CountingGpu::onTest = {};
  EXPECT_EQ(testDevice("vulkan").problem, "");
  EXPECT_TRUE(isUsed());
  EXPECT_EQ(CountingGpu::tests, 2);
}

TEST_F(DeviceTrust, IsLostWithTheDevice) {
  CountingGpu::onTest = [](const DeviceTestReport& report) {
    report.begin("crossings", 0.5);
    throw Error(ErrorCode::DeviceLost, "it went away");
  };
  expectRefused({"crossings: it went away"});
}

TEST_F(DeviceTrust, EndsWithAnotherDriver) {
  EXPECT_TRUE(isUsed());
  CountingGpu::fingerprint += "1";
  EXPECT_EQ(info().test, DeviceTestState::Untested);
  EXPECT_TRUE(isUsed());
  EXPECT_EQ(CountingGpu::tests, 2);
  EXPECT_EQ(files().size(), 2u);
}

TEST_F(DeviceTrust, EndsWithOtherKernels) {
  CountingGpu::onTest = fail;
  EXPECT_FALSE(isUsed());
  CountingGpu::onTest = {};
  CountingGpu::kernels = uint64_t{1} << 63;
  EXPECT_EQ(info().test, DeviceTestState::Untested);
  EXPECT_TRUE(isUsed());
  EXPECT_EQ(CountingGpu::tests, 2);
  CountingGpu::kernels = 1;
  expectRefused({"refine"});
}

TEST_F(DeviceTrust, IgnoresDamagedFiles) {
  EXPECT_TRUE(isUsed());
  const fs::path file = onlyFile();
  const std::string whole = readBytes(file);
  int tests = 1;
  const auto expectAnotherTest = [&](const std::string& content) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << content;
    EXPECT_TRUE(isUsed());
    EXPECT_EQ(CountingGpu::tests, ++tests) << content;
    EXPECT_EQ(readBytes(file), whole);
  };
  for (size_t length = 0; length + 1 < whole.size(); length += 7) expectAnotherTest(whole.substr(0, length));
  expectAnotherTest(std::string(100, '\0'));
  const auto replaced = [&](const std::string& from, const std::string& to) {
    return std::string(whole).replace(whole.find(from), from.size(), to);
  };
  expectAnotherTest(replaced("test 1", "test 2"));
  expectAnotherTest(replaced("Counter 1.0", "Counter 2.0"));
  expectAnotherTest(replaced("passed", "failed"));
  expectAnotherTest(replaced("passed\n", "passed\nwith a problem"));
}

TEST_F(DeviceTrust, IsRememberedWhereNothingCanBeWritten) {
  const fs::path file = folder_.path() / "file";
  std::ofstream(file) << "no folder";
  for (const std::string& cache : {std::string("off"), file.string()}) {
    const ScopedVariable variable("RAYMAP_CACHE", cache);
    CountingGpu::fingerprint += "1";
    CountingGpu::tests = 0;
    for (int time = 0; time < 2; ++time) EXPECT_TRUE(isUsed());
    EXPECT_EQ(CountingGpu::tests, 1);
    CountingGpu::onTest = fail;
    EXPECT_NE(testDevice("vulkan:3").problem, "");
    expectRefused({"refine"});
    CountingGpu::onTest = {};
  }
  EXPECT_EQ(readBytes(onlyFile()), "no folder");
}

TEST_F(DeviceTrust, IsMarkedWhileATestRuns) {
  CountingGpu::onTest = [&](const DeviceTestReport& report) {
    for (const char* check : {"radix_sort", "sign"}) {
      report.begin(check, 0.0);
      EXPECT_EQ(readBytes(onlyFile()), check);
      EXPECT_EQ(info().test, DeviceTestState::Running);
    }
  };
  EXPECT_EQ(testDevice("vulkan:3").problem, "");
}

TEST_F(DeviceTrust, IsRefusedAfterATestThatDidNotEnd) {
  leaveMark("exact_distance");
  EXPECT_EQ(info().test, DeviceTestState::Unfinished);
  expectRefused({"vulkan:3", "Counting GPU", "exact_distance", "test it again"});
  EXPECT_EQ(CountingGpu::tests, 0);
  EXPECT_EQ(deviceToTest(), "");
  EXPECT_EQ(testDevice("vulkan:3").problem, "");
  EXPECT_TRUE(isUsed());
  EXPECT_EQ(CountingGpu::tests, 1);
}

TEST_F(DeviceTrust, IsRefusedAfterACheckThatHangs) {
  std::promise<void> end, ended;
  CountingGpu::onTest = [&](const DeviceTestReport& report) {
    report.begin("scan", 0.0);
    report.found({.name = "scan"});
    report.begin("refine", 0.5);
    end.get_future().wait();
    EXPECT_FALSE(report.begin("sign", 0.6)) << "nobody waits for it any more";
    ended.set_value();
  };
  const auto hangs = [](const std::string& check, double) { return check == "refine"; };
  const DeviceTest test = testGpu(info(), kGpu, {}, hangs);
  EXPECT_TRUE(test.hangs);
  EXPECT_EQ(test.checks.size(), 1u);
  EXPECT_TRUE(contains(test.problem, "refine: did not end")) << test.problem;
  expectRefused({"refine: did not end"});
  end.set_value();
  ended.get_future().wait();
  EXPECT_EQ(CountingGpu::tests, 1);
}

TEST_F(DeviceTrust, IsAskedAgainAfterATestThatWasCancelled) {
  CountingGpu::onTest = [](const DeviceTestReport& report) {
    while (report.begin("scan", 0.25)) std::this_thread::yield();
  };
  const auto cancel = [](std::string_view stage, double done) {
    EXPECT_TRUE(contains(std::string(stage), "vulkan:3"));
    return done < 0.25;
  };
  EXPECT_EQ(codeOf([&] { chooseDevice({.progress = cancel}); }), ErrorCode::Cancelled);
  EXPECT_TRUE(files().empty());
  CountingGpu::onTest = {};
  EXPECT_TRUE(isUsed());
}

TEST_F(DeviceTrust, WaitsForTheTestOfAnother) {
  const DeviceInfo device = info();
  std::promise<void> begun, end;
  CountingGpu::onTest = [&](const DeviceTestReport& report) {
    report.begin("scan", 0.0);
    begun.set_value();
    end.get_future().wait();
  };
  const auto once = [&] { return testOnce(device, kGpu, {}); };
  auto first = std::async(std::launch::async, once);
  begun.get_future().wait();
  auto second = std::async(std::launch::async, once);
  EXPECT_EQ(readRecord(device).state, DeviceTestState::Running);
  end.set_value();
  EXPECT_EQ(first.get(), DeviceTestState::Passed);
  EXPECT_EQ(second.get(), DeviceTestState::Passed);
  EXPECT_EQ(CountingGpu::tests, 1);
}

TEST_F(DeviceTrust, TakesNoTestThatEndsForOneThatCrashed) {
  const DeviceInfo device = info();
  std::atomic<bool> isOver{false};
  auto tests = std::async(std::launch::async, [&] {
    for (int k = 0; k < 100; ++k) {
      const TestMark mark(device, 1e9);
      writeRecord(device, {DeviceTestState::Passed});
    }
    isOver = true;
  });
  while (!isOver) ASSERT_NE(readRecord(device).state, DeviceTestState::Unfinished);
  tests.get();
  EXPECT_EQ(readRecord(device).state, DeviceTestState::Passed);
}

TEST_F(DeviceTrust, GivesUpOnTheTestOfAnother) {
  const TestMark mark(info(), 1.0);
  try {
    const TestMark other(info(), 0.05);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
    EXPECT_TRUE(contains(error.what(), "another process")) << error.what();
  }
}

TEST_F(DeviceTrust, IsForGpusOnly) {
  for (const char* name : {"cpu", "auto", "gpu", ""}) try {
      testDevice(name);
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Usage) << name;
    }
  for (const char* name : {"vulkan:1", "vulkan:4"}) EXPECT_THROW(testDevice(name), Error);
  EXPECT_EQ(CountingGpu::tests, 0);
}

}  // namespace
}  // namespace raymap
