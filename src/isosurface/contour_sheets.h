#pragma once

#include <functional>
#include <vector>

#include "isosurface/contour_cubes.h"
#include "isosurface/plane_fit.h"

namespace raymap {

/// Function that adds to `fit`, in samples, where and how the surface crosses the lattice edge between two
/// samples. It calls `addCrossing` at least once and may run on any thread. `outside` may lie one step beyond
/// the grid.
using AddPlanes = std::function<void(const glm::ivec3& inside, const glm::ivec3& outside, PlaneFit& fit)>;

/// Positions of the surface's sheets in the cubes.
class ContourSheets {
 public:
  ContourSheets(const ContourCubes& cubes, const AddPlanes& addPlanes)
      : cubes_(cubes), addPlanes_(addPlanes) {}

  /// Returns a fit for each sheet of a cube.
  std::vector<PlaneFit> fit(const ContourCube& cube, const glm::ivec3& place) const;
  /// Returns the point where the surface crosses a quad's lattice edge. It is never an end of the edge.
  glm::dvec3 crossing(uint32_t quad) const;

 private:
  void addEdge(const ContourCube& cube, const glm::ivec3& place, int edge, PlaneFit& fit) const;

  const ContourCubes& cubes_;
  const AddPlanes& addPlanes_;
};

}  // namespace raymap
