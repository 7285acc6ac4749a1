#pragma once

#include <raymap/machine.h>
#include <raymap/picture.h>

#include "scene/scene.h"

namespace raymap {

/// Draws a scene as `renderField` does.
Picture renderScene(const Scene& scene, const RenderOptions& options, const MachineOptions& machine);

}  // namespace raymap
