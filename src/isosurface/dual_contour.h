#pragma once

#include <raymap/grid.h>

#include "base/progress.h"
#include "isosurface/contour_sheets.h"

namespace raymap {

/// Fills `result` with the surface of the solid whose samples have values below 0, reusing its memory.
/// `cubes` are those of `findCubes`, and everything beyond the grid is outside. Whatever the samples, each
/// edge has exactly two faces with consistent winding order, and the faces around a vertex form one disc.
/// Faces cross only where two sheets pass a cube too close to each other. Throws `Error(Memory)` or
/// `Error(Unsupported)` if the surface has too many vertices.
void dualContour(const Grid& grid, ContourRows cubes, const ContourCubes::SampleValue& value,
                 const AddPlanes& addPlanes, Progress& progress, Mesh& result);

}  // namespace raymap
