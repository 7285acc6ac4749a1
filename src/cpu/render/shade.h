#pragma once

#include "scene/scene.h"

namespace raymap::cpu {

/// Returns the colour of a pixel.
Colour pixelColour(const DrawnScene& scene, int x, int y);

}  // namespace raymap::cpu
