#include "vulkan/self_test/self_test.h"

#include <raymap/error.h>

#include <chrono>
#include <vector>

#include "vulkan/self_test/checks.h"

namespace raymap::vulkan {

namespace {

std::vector<Check> allChecks() {
  std::vector<Check> checks;
  for (const auto part :
       {checksOfPrimitives, checksOfCells, checksOfSurface, checksOfSign, checksOfFields})
    for (const Check& check : part()) checks.push_back(check);
  return checks;
}

/// Runs a check. Returns whether the device is still there.
bool run(const Check& check, Subject& subject, std::string& difference) {
  try {
    check.run(subject);
  } catch (const Error& error) {
    difference = error.what();
    return error.code() != ErrorCode::DeviceLost;
  } catch (const std::exception& found) {  // A Difference, or what results out of range led to.
    difference = found.what();
  }
  return true;
}

}  // namespace

void testDevice(size_t index, const DeviceTestReport& report) {
  using Clock = std::chrono::steady_clock;
  if (!report.begin("start", 0.0)) return;
  Device device({.index = index});
  Subject subject(device);
  const std::vector<Check> checks = allChecks();
  for (size_t c = 0; c < checks.size(); ++c) {
    if (!report.begin(checks[c].name, double(c) / double(checks.size()))) return;
    const Clock::time_point start = Clock::now();
    DeviceCheck result{.name = checks[c].name};
    const bool isThere = run(checks[c], subject, result.difference);
    result.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    report.found(std::move(result));
    if (!isThere) return;
  }
}

}  // namespace raymap::vulkan
