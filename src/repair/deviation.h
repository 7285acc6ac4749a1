#pragma once

#include <raymap/grid.h>
#include <raymap/repair.h>

#include <span>
#include <vector>

#include "base/progress.h"

namespace raymap {

/// Points all over a mesh, in samples of the grid: its vertices, and on its triangles so densely that no
/// point of them is farther than about `step` from one; more sparsely if they would be too many.
std::vector<glm::vec3> surfacePoints(const Mesh& mesh, const Grid& grid, double step);

/// The exact distance of points to a mesh, all in samples of the grid.
std::vector<float> distancesTo(const Mesh& mesh, const Grid& grid, std::span<const glm::vec3> points,
                               Progress& progress);

/// Of deviations in samples, which it puts into another order.
Deviation summarize(std::vector<float>& deviations, double spacing);

}  // namespace raymap
