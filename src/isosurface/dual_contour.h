#pragma once

#include <raymap/field.h>

#include "base/progress.h"
#include "isosurface/contour_sheets.h"

namespace raymap {

/// The surface of the solid whose samples are below `iso`; what lies outside of the grid is outside. Every
/// edge has exactly two faces, which agree in orientation, and the faces around each vertex make one disc,
/// whatever the samples. Faces cross only where two sheets pass a cube too close to each other. Throws
/// `Error(Memory)` or `Error(Unsupported)` if it has too many vertices.
Mesh dualContour(const Field& field, double iso, const AddPlanes& addPlanes, Progress& progress);

}  // namespace raymap
