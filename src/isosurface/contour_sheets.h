#pragma once

#include <functional>
#include <vector>

#include "isosurface/contour_cubes.h"
#include "isosurface/plane_fit.h"

namespace raymap {

/// Tells a fit, in samples, how the surface lies where it crosses the lattice edge between two samples: at
/// least one `addCrossing`. Called by any thread. `outside` may lie a step outside of the grid.
using AddPlanes = std::function<void(const glm::ivec3& inside, const glm::ivec3& outside, PlaneFit& fit)>;

/// Where the sheets of surface lie that pass the cubes.
class ContourSheets {
 public:
  ContourSheets(const ContourCubes& cubes, const AddPlanes& addPlanes)
      : cubes_(cubes), addPlanes_(addPlanes) {}

  /// Of the sheets of a cube.
  std::vector<PlaneFit> fit(const ContourCube& cube, const glm::ivec3& place) const;
  /// Where the surface crosses a quad's edge of the lattice: never where such edges meet.
  glm::dvec3 crossing(uint32_t quad) const;

 private:
  void addEdge(const ContourCube& cube, const glm::ivec3& place, int edge, PlaneFit& fit) const;

  const ContourCubes& cubes_;
  const AddPlanes& addPlanes_;
};

}  // namespace raymap
