#pragma once

// How a GPU backend joins the core, which does not know it. raymap::vulkan plugs itself in where it is
// linked.

#include <raymap/devices.h>
#include <raymap/generate.h>
#include <raymap/render.h>

#include <memory>
#include <vector>

#include "method/backend.h"

namespace raymap {

struct Scene;

/// A device, and what it keeps between runs.
class GpuDevice {
 public:
  virtual ~GpuDevice() = default;
  /// Makes the job's field; fills all of the statistics but the total time. After an error for which
  /// `isOfTheDevice` it must not be used again.
  virtual void generate(const Job& job, Stats& stats) = 0;
  /// Draws the scene into the picture, whose size is set.
  virtual void draw(const Scene& scene, Progress& progress, Picture& picture) = 0;
};

/// The functions of a GPU backend. They throw `Error(Unsupported)` where there is no driver or no such
/// device.
struct GpuPlugIn {
  /// Lists the devices in the order of their numbers.
  std::vector<DeviceInfo> (*list)();
  /// Opens a device by its number.
  std::unique_ptr<GpuDevice> (*open)(size_t index);
};

/// Called once, before `main`.
void plugIn(const GpuPlugIn& gpu);
/// Returns the GPU backend, or null where none is linked.
const GpuPlugIn* gpuPlugIn();

}  // namespace raymap
