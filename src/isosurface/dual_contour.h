#pragma once

#include <raymap/field.h>

#include "base/progress.h"
#include "isosurface/contour_sheets.h"

namespace raymap {

/// Fills `result` with the surface of the solid whose samples are below `iso`, reusing its memory. Everything
/// beyond the grid is outside. Whatever the samples, each edge has exactly two faces with consistent winding
/// order, and the faces around a vertex form one disc. Faces cross only where two sheets pass a cube too
/// close to each other. Throws `Error(Memory)` or `Error(Unsupported)` if the surface has too many vertices.
void dualContour(const Field& field, double iso, const AddPlanes& addPlanes, Progress& progress,
                 Mesh& result);

}  // namespace raymap
