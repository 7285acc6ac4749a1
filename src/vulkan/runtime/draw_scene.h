#pragma once

#include <raymap/render.h>

#include <cstddef>

#include "base/progress.h"

namespace raymap {
struct Scene;
}

namespace raymap::vulkan {

class Device;

/// Fills the picture, of the size that it has. Throws `Error`: Unsupported, Memory, DeviceLost, Cancelled.
void drawScene(Device& device, const Scene& scene, Progress& progress, Picture& picture);

}  // namespace raymap::vulkan
