#pragma once

#include <raymap/picture.h>

#include <cstddef>

#include "base/progress.h"

namespace raymap {
struct DrawnScene;
}

namespace raymap::vulkan {

class Device;

/// Draws a picture of the size of `picture`. Throws `Error`: Unsupported, Memory, DeviceLost, Cancelled.
void drawScene(Device& device, const DrawnScene& scene, Progress& progress, Picture& picture);

}  // namespace raymap::vulkan
