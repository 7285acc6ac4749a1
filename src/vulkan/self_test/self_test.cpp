#include "vulkan/self_test/self_test.h"

#include <vector>

#include "base/stopwatch.h"
#include "vulkan/self_test/checks.h"

namespace raymap::vulkan {

namespace {

std::vector<Check> allChecks() {
  std::vector<Check> checks;
  for (const auto part :
       {checksOfPrimitives, checksOfCells, checksOfSurface, checksOfSign, checksOfFields, checksOfFrames})
    for (const Check& check : part()) checks.push_back(check);
  return checks;
}

/// Returns the first difference that a check finds; empty if there is none.
std::string differenceIn(const Check& check, Subject& subject) {
  try {
    check.run(subject);
  } catch (const std::exception& found) {  // A Difference, or what results out of range led to.
    return found.what();
  }
  return {};
}

}  // namespace

void testDevice(size_t index, const DeviceTestReport& report) {
  if (!report.begin("start", 0.0)) return;
  Device device({.index = index});
  Subject subject(device);
  const std::vector<Check> checks = allChecks();
  for (size_t c = 0; c < checks.size(); ++c) {
    if (!report.begin(checks[c].name, double(c) / double(checks.size()))) return;
    const Stopwatch stopwatch;
    DeviceCheck result{.name = checks[c].name};
    result.difference = differenceIn(checks[c], subject);
    result.milliseconds = stopwatch.milliseconds();
    const bool isPassed = result.difference.empty();
    report.found(std::move(result));
    // Later stages read the results of this one, and wrong ones may end the process.
    if (!isPassed) return;
  }
}

}  // namespace raymap::vulkan
