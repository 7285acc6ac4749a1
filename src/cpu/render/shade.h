#pragma once

#include "picture/drawn_scene.h"

namespace raymap::cpu {

/// Returns the colour of a pixel.
Colour pixelColour(const DrawnScene& scene, int x, int y);

}  // namespace raymap::cpu
