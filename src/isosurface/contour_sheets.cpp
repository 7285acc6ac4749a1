#include "isosurface/contour_sheets.h"

namespace raymap {

std::vector<PlaneFit> ContourSheets::fit(const ContourCube& cube, const glm::ivec3& place) const {
  std::vector<PlaneFit> sheets(size_t(cube.cycles.count()), PlaneFit(place - 1));
  for (int edge = 0; edge < kCubeEdges; ++edge)
    if (isEdgeCrossed(cube.corners, edge)) addEdge(cube, place, edge, sheets[size_t(cube.cycles.of(edge))]);
  return sheets;
}

void ContourSheets::addEdge(const ContourCube& cube, const glm::ivec3& place, int edge, PlaneFit& fit) const {
  const int from = edgeStart(edge), to = edgeEnd(edge);
  const bool isIn = isCornerInside(cube.corners, from);
  const glm::ivec3 start = place - 1 + cornerOffset(from), end = place - 1 + cornerOffset(to);
  addPlanes_(isIn ? start : end, isIn ? end : start, fit);
}

glm::dvec3 ContourSheets::crossing(uint32_t quad) const {
  const auto [cube, place] = cubes_.ofQuad(quad);
  uint32_t number = quad - cube.firstQuad;
  int axis = 0;
  for (; !cube.isCrossed(axis) || number > 0; ++axis) number -= cube.isCrossed(axis) ? 1 : 0;
  PlaneFit fit(place - 1);
  addEdge(cube, place, 4 * axis, fit);
  glm::dvec3 p(place - 1);
  p[axis] = fit.mean()[axis];
  return p;
}

}  // namespace raymap
