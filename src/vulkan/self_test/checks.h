#pragma once

// The checks of the self-test. Each runs a stage, or makes a field, on the device and compares the result
// with the CPU's, or with an independent reference. It throws a `Difference`.

#include <span>
#include <string>

#include "vulkan/runtime/backend.h"
#include "vulkan/self_test/cell_probe.h"
#include "vulkan/self_test/sign_probe.h"
#include "vulkan/self_test/surface_probe.h"

namespace raymap::vulkan {

/// A device with the stages and the backend that its checks share.
struct Subject {
  explicit Subject(Device& on) : probe(on), cells(on), surface(on), signs(on), backend(on) {}

  Probe probe;
  CellProbe cells;
  SurfaceProbe surface;
  SignProbe signs;
  Backend backend;
};

struct Check {
  const char* name;
  void (*run)(Subject& subject);
};

/// Check of inputs that take several dispatches, or more than one dimension of groups.
inline constexpr const char* kLargeInputs = "large inputs";

/// Returns the name of a case.
inline std::string nameOf(const CellMesh& mesh) {
  return textOf(mesh.triangles.size()) + " triangles in " + textOf(mesh.dims, " x ");
}

/// Returns all checks in the order of the stages: each relies on those before it.
std::span<const Check> allChecks();

void checkScan(Subject& subject);
void checkRadixSort(Subject& subject);
void checkCellMesh(Subject& subject);
void checkVoxelGrid(Subject& subject);
void checkTransform(Subject& subject);
void checkRasterDistance(Subject& subject);
void checkRefine(Subject& subject);
void checkLargeInputs(Subject& subject);
void checkSurfaceTree(Subject& subject);
void checkExactDistance(Subject& subject);
void checkDipoles(Subject& subject);
void checkFaceSearch(Subject& subject);
void checkRays(Subject& subject);
void checkHarmonic(Subject& subject);
void checkRims(Subject& subject);
void checkPaths(Subject& subject);
void checkOrientation(Subject& subject);
void checkCloseHoles(Subject& subject);
void checkFinish(Subject& subject);
void checkDefault(Subject& subject);
void checkQuick(Subject& subject);
void checkModes(Subject& subject);
void checkTurns(Subject& subject);
void checkHoles(Subject& subject);
void checkSkin(Subject& subject);
void checkFieldImage(Subject& subject);
void checkRenderField(Subject& subject);

}  // namespace raymap::vulkan
