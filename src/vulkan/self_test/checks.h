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

// In the order of the stages: each relies on those before it.
std::span<const Check> checksOfPrimitives();
std::span<const Check> checksOfCells();
std::span<const Check> checksOfSurface();
std::span<const Check> checksOfSign();
std::span<const Check> checksOfFields();
std::span<const Check> checksOfFrames();

}  // namespace raymap::vulkan
