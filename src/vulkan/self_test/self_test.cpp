#include "vulkan/self_test/self_test.h"

#include "base/stopwatch.h"
#include "vulkan/self_test/checks.h"

namespace raymap::vulkan {

namespace {

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

std::span<const Check> allChecks() {
  static constexpr Check kChecks[] = {
      {"scan", checkScan},
      {"radix_sort", checkRadixSort},
      {"cell_mesh", checkCellMesh},
      {"voxel_grid", checkVoxelGrid},
      {"distance_transform", checkTransform},
      {"cell and raster distance", checkRasterDistance},
      {"refine", checkRefine},
      {kLargeInputs, checkLargeInputs},
      {"surface_tree", checkSurfaceTree},
      {"exact_distance", checkExactDistance},
      {"winding_dipoles", checkDipoles},
      {"face_search", checkFaceSearch},
      {"crossings and rays", checkRays},
      {"winding_harmonic", checkHarmonic},
      {"winding_rims", checkRims},
      {"winding_paths", checkPaths},
      {"orientation", checkOrientation},
      {"close_holes", checkCloseHoles},
      {"finish", checkFinish},
      {"default fields", checkDefault},
      {"quick fields", checkQuick},
      {"fields of other modes", checkModes},
      {"fields of turned faces", checkTurns},
      {"fields with closed holes", checkHoles},
      {"skin", checkSkin},
      {"field_image", checkFieldImage},
      {"render_field", checkRenderField},
  };
  return kChecks;
}

void testDevice(size_t index, const DeviceTestReport& report) {
  if (!report.begin("start", 0.0)) return;
  Device device({.index = index});
  Subject subject(device);
  const std::span<const Check> checks = allChecks();
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
