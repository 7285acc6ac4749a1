#pragma once

#include <raymap/machine.h>
#include <raymap/picture.h>

#include "picture/drawn_scene.h"

namespace raymap {

/// Draws a scene as `renderField` does.
Picture renderScene(const DrawnScene& scene, const RenderOptions& options, const MachineOptions& machine);

/// Throws `Error` unless an array has a finite number per sample: Usage if it has another count, else Input.
/// Samples of a narrow band that lie in no leaf have none.
void checkNumbers(const Field& field, FieldArray array);

}  // namespace raymap
