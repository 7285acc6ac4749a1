#pragma once

#include <raymap/devices.h>

#include <functional>
#include <string>

namespace raymap {

/// Function that says whether a check which has taken some seconds never ends.
using Hangs = std::function<bool(const std::string& check, double seconds)>;

/// Seconds that one check may take. A driver that compiles slowly takes a few.
constexpr double kCheckSeconds = 60.0;
inline bool takesTooLong(const std::string&, double seconds) {
  return seconds > kCheckSeconds;
}
/// Seconds to wait for a test of the same device in another process.
constexpr double kOtherTestSeconds = 10.0;

/// Tests a GPU by its number and records the result. Throws `Error(Cancelled)` if `progress` returns false.
DeviceTest testGpu(const DeviceInfo& device, size_t number, const ProgressCallback& progress,
                   const Hangs& hangs = takesTooLong);

/// Returns the recorded result for a GPU. Tests it first if there is none.
DeviceTestState testOnce(const DeviceInfo& device, size_t number, const ProgressCallback& progress);

/// Returns "vulkan:0 (NAME, driver DRIVER) failed its test: ..." or why else its test is void.
std::string reasonAgainst(const DeviceInfo& device);

}  // namespace raymap
