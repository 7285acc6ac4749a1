// Choice of the device of a run, also when a GPU fails.

#include "api/devices.h"
#include "error_code.h"

#include <gtest/gtest.h>

#include <string>

#include "counting_gpu.h"

namespace raymap {
namespace {

struct Attempt {
  int onGpu = 0;
  bool isLeftToTheCpu = false;
  Warning warning;
};

/// Runs work on the usable device that throws an error with this code.
Attempt runFailing(ChosenDevice& device, ErrorCode code, const std::string& name) {
  Attempt attempt;
  const auto warn = [&](const Warning& given) { attempt.warning = given; };
  const bool isDone = device.run({.device = name, .warn = warn}, [&](GpuDevice&, size_t number) {
    EXPECT_EQ(number, CountingGpu::kUsable);
    ++attempt.onGpu;
    throw Error(code, "the reason");
  });
  attempt.isLeftToTheCpu = !isDone;
  return attempt;
}

/// Runs work on the usable device that succeeds.
void runWell(ChosenDevice& device, const std::string& name) {
  int onGpu = 0;
  EXPECT_TRUE(device.run({.device = name}, [&](GpuDevice&, size_t) { ++onGpu; }));
  EXPECT_EQ(onGpu, 1);
}

TEST(Devices, FallBackToTheCpuAndSayWhy) {
  const CountingGpu gpu;
  for (const ErrorCode code :
       {ErrorCode::DeviceLost, ErrorCode::DeviceMemory, ErrorCode::Memory, ErrorCode::Unsupported}) {
    ChosenDevice device;
    const Attempt attempt = runFailing(device, code, "auto");
    EXPECT_EQ(attempt.onGpu, 1);
    EXPECT_TRUE(attempt.isLeftToTheCpu);
    EXPECT_EQ(attempt.warning.message, "the CPU was used instead of the GPU: the reason");
    EXPECT_EQ(attempt.warning.code, WarningCode::DeviceFailed);
    EXPECT_EQ(attempt.warning.fields.device, "vulkan:3");
  }
}

TEST(Devices, PassOnErrorsThatTheCpuWouldHaveToo) {
  const CountingGpu gpu;
  ChosenDevice device;
  for (const ErrorCode code : {ErrorCode::Input, ErrorCode::Usage, ErrorCode::Cancelled})
    EXPECT_THROW(runFailing(device, code, "auto"), Error);
}

TEST(Devices, PassOnErrorsOfADeviceThatWasNamed) {
  const CountingGpu gpu;
  ChosenDevice device;
  EXPECT_THROW(runFailing(device, ErrorCode::DeviceLost, "vulkan:3"), Error);
}

TEST(Devices, StayOpenAfterErrorsOfTheCall) {
  const CountingGpu gpu;
  for (const ErrorCode code : {ErrorCode::Input, ErrorCode::Usage, ErrorCode::Cancelled})
    for (const char* name : {"auto", "vulkan", "vulkan:3"}) {
      SCOPED_TRACE(testing::Message() << name << ", error " << int(code));
      ChosenDevice device;
      CountingGpu::lists = CountingGpu::opens = 0;
      EXPECT_THROW(runFailing(device, code, name), Error);
      runWell(device, name);
      EXPECT_EQ(CountingGpu::lists, 1);
      EXPECT_EQ(CountingGpu::opens, 1);
    }
}

TEST(Devices, AreClosedAfterErrorsOfTheDevice) {
  const CountingGpu gpu;
  for (const ErrorCode code : {ErrorCode::DeviceLost, ErrorCode::Memory, ErrorCode::Unsupported}) {
    SCOPED_TRACE(testing::Message() << "error " << int(code));
    ChosenDevice device;
    CountingGpu::opens = 0;
    EXPECT_THROW(runFailing(device, code, "vulkan:3"), Error);
    runWell(device, "vulkan:3");
    EXPECT_EQ(CountingGpu::opens, 2);
  }
}

TEST(Devices, TakeTheCpuWhereNoneIsChosen) {
  const CountingGpu gpu;
  ChosenDevice device;
  EXPECT_FALSE(device.run({.device = "cpu"}, [](GpuDevice&, size_t) { ADD_FAILURE(); }));
  EXPECT_EQ(CountingGpu::lists, 0);
}

TEST(Devices, RefuseUnknownNames) {
  for (const char* name : {"gpu", "vulkan:", "vulkan:x", "vulkan:0x", ""})
    EXPECT_THROW(chooseDevice({.device = name}), Error);
}

TEST(Devices, SayWhyOneCannotBeUsed) {
  const CountingGpu gpu;
  for (const auto& refused : {std::pair("vulkan:1", "made for a test"), {"vulkan:4", "no device"}}) {
    const auto choose = [&] { chooseDevice({.device = refused.first}); };
    EXPECT_NE(messageOf(ErrorCode::Unsupported, choose).find(refused.second), std::string::npos);
  }
}

}  // namespace
}  // namespace raymap
