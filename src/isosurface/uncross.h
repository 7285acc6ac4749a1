#pragma once

#include <raymap/grid.h>
#include <raymap/mesh.h>

#include <vector>

#include "isosurface/contour_sheets.h"

namespace raymap {

/// Takes away where faces of a surface cross (Ju & Udeshi 2006). Triangles 2q and 2q + 1 of `mesh` are
/// corners 0, 1, 2 and 0, 2, 3 of quad q; a vertex lies at the spacing times its place in samples, seen from
/// the grid's middle.
///
/// Each quad has a part of the four cubes around its edge of the lattice: tetrahedra between that edge and
/// the quad's sides. Parts do not overlap where cubes have one sheet. Halves of a quad may leave it: such
/// quads, and those of cubes with several sheets, are suspect. A fan of four triangles around the point where
/// the surface crosses the edge never does. So quads become fans, but only those that cross something, and
/// those around them in the next round. What then still crosses are two sheets in one cube: the vertices
/// there move into the means of their crossings.
void uncross(const ContourCubes& cubes, const ContourSheets& sheets, const Grid& grid,
             std::vector<uint8_t> isSuspect, Mesh& mesh, Progress& progress);

}  // namespace raymap
