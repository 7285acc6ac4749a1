// What is run where, and what happens when a GPU fails.

#include "api/devices.h"

#include <gtest/gtest.h>

#include <string>

namespace raymap {
namespace {

struct Outcome {
  int onGpu = 0, onCpu = 0;
  std::string warning;
};

/// Runs on device 3, which fails with `code`.
Outcome runFailing(ErrorCode code, bool mayFallBack) {
  Outcome run;
  runOnChosen(
      3, mayFallBack, [&](std::string_view text) { run.warning = text; },
      [&](size_t index) {
        EXPECT_EQ(index, 3u);
        ++run.onGpu;
        throw Error(code, "the reason");
      },
      [&] { ++run.onCpu; });
  return run;
}

TEST(Devices, FallBackToTheCpuAndSayWhy) {
  for (const ErrorCode code : {ErrorCode::DeviceLost, ErrorCode::Memory, ErrorCode::Unsupported}) {
    const Outcome run = runFailing(code, true);
    EXPECT_EQ(run.onGpu, 1);
    EXPECT_EQ(run.onCpu, 1);
    EXPECT_NE(run.warning.find("the reason"), std::string::npos) << run.warning;
  }
}

TEST(Devices, PassOnWhatTheCpuCouldNotMend) {
  for (const ErrorCode code : {ErrorCode::Input, ErrorCode::Usage, ErrorCode::Cancelled})
    EXPECT_THROW(runFailing(code, true), Error);
}

TEST(Devices, PassOnWhatADeviceNamedCannotDo) {
  EXPECT_THROW(runFailing(ErrorCode::DeviceLost, false), Error);
}

TEST(Devices, TakeTheCpuWhereNoneIsChosen) {
  int onCpu = 0;
  runOnDevice(
      "cpu", nullptr, [](size_t) { ADD_FAILURE(); }, [&] { ++onCpu; });
  EXPECT_EQ(onCpu, 1);
}

TEST(Devices, RefuseNamesThatAreNone) {
  for (const char* name : {"gpu", "vulkan:", "vulkan:x", "vulkan:0x", ""})
    EXPECT_THROW(chooseDevice(name), Error);
}

}  // namespace
}  // namespace raymap
