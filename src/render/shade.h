#pragma once

#include "scene.h"

namespace raymap {

/// What a pixel shows.
Colour pixelColour(const Scene& scene, int x, int y);

}  // namespace raymap
