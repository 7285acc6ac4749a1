#pragma once

// Registration of a GPU backend with the core, which does not depend on it. raymap::vulkan registers itself
// if it is linked.

#include <raymap/device_info.h>
#include <raymap/options.h>
#include <raymap/picture.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "method/backend_concepts.h"

namespace raymap {

struct DrawnScene;

/// Open device, with the memory that it keeps between runs.
class GpuDevice {
 public:
  virtual ~GpuDevice() = default;
  /// Computes the job's field and fills all statistics except the total time. The device must not be used
  /// again after an error for which `isOfTheDevice` returns true.
  virtual void generate(const Job& job, Stats& stats) = 0;
  /// Draws the scene into the picture, whose size is set.
  virtual void draw(const DrawnScene& scene, Progress& progress, Picture& picture) = 0;
};

/// Receives what a test of a device does.
struct DeviceTestReport {
  /// Called before each check with its name and the share of all checks that is done. Returns false to stop.
  std::function<bool(const char* name, double done)> begin;
  std::function<void(DeviceCheck check)> found;
};

/// Functions of a GPU backend. They throw `Error(Unsupported)` if there is no driver or no such device.
struct GpuPlugIn {
  /// Lists the devices in the order of their numbers.
  std::vector<DeviceInfo> (*list)();
  /// Opens a device by its number.
  std::unique_ptr<GpuDevice> (*open)(size_t index);
  /// Runs all checks of a device (src/vulkan/self_test/checks.h). Ends after the first that fails.
  void (*test)(size_t index, const DeviceTestReport& report);
  /// Returns whether the system shows a GPU at all, which takes much less time than `list`.
  bool (*mayHaveGpu)();
  /// Returns a hash of all kernels. The result of a test holds for these.
  uint64_t (*kernelHash)();
};

/// Registers a GPU backend. Called once, before `main`.
void plugIn(const GpuPlugIn& gpu);
/// Returns the GPU backend, or null if none is linked.
const GpuPlugIn* gpuPlugIn();

}  // namespace raymap
