#pragma once

#include <raymap/grid.h>
#include <raymap/mesh.h>

#include <vector>

#include "isosurface/contour_sheets.h"

namespace raymap {

/// Removes crossings between faces of a surface (Ju & Udeshi 2006). Triangles 2q and 2q + 1 of `mesh` have
/// corners 0, 1, 2 and 0, 2, 3 of quad q. Vertices are relative to the grid's middle and multiplied by the
/// spacing.
///
/// Each quad owns a part of the four cubes around its lattice edge: the tetrahedra between that edge and the
/// quad's sides. Parts do not overlap where cubes have one sheet. The halves of a quad may leave its part.
/// Such quads are suspect, and so are quads of cubes with several sheets.
///
/// A fan of four triangles around the point where the surface crosses the edge never leaves the part. So
/// quads become fans, but only those that cross something; crossings with new fans are mended in the next
/// round. Fans that still cross belong to two sheets in one cube. Their vertices move to the means of their
/// crossings.
void uncross(const ContourCubes& cubes, const ContourSheets& sheets, const Grid& grid,
             std::vector<uint8_t> isSuspect, Mesh& mesh, Progress& progress);

}  // namespace raymap
