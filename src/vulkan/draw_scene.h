#pragma once

#include <raymap/render.h>

#include <cstddef>

#include "progress.h"

namespace raymap {
struct Scene;
}

// Knows nothing of Vulkan's types, so that others may include it.
namespace raymap::vulkan {

class Device;

/// Fills the picture, of the size that it has. Throws `Error`: Unsupported, Memory, DeviceLost, Cancelled.
void drawScene(Device& device, const Scene& scene, Progress& progress, Picture& picture);
/// `index` as in `listDevices`.
void drawScene(size_t index, const Scene& scene, Progress& progress, Picture& picture);

}  // namespace raymap::vulkan
