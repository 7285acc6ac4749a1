#pragma once

#include <raymap/grid.h>
#include <raymap/repair.h>

#include <span>
#include <vector>

#include "base/progress.h"
#include "mesh/packed_mesh.h"

namespace raymap {

/// Returns points of a mesh, in samples of the grid: its vertices and points on its triangles. Every point of
/// a triangle is within about `step` samples of one. The points are sparser if there would be too many.
std::vector<glm::vec3> surfacePoints(const PackedMesh& mesh, const Grid& grid, double step);

/// Returns the exact distances of points to a mesh, all in samples of the grid.
std::vector<float> distancesTo(const PackedMesh& mesh, const Grid& grid, std::span<const glm::vec3> points,
                               Progress& progress);

/// Returns statistics of `deviations`, multiplied by `spacing`. The deviations are in samples and get
/// reordered.
Deviation summarize(std::vector<float>& deviations, double spacing);

}  // namespace raymap
