#pragma once

#include "scene/scene.h"

namespace raymap {

/// What a pixel shows.
Colour pixelColour(const Scene& scene, int x, int y);

}  // namespace raymap
