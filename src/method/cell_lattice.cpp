// Krayer & Müller 2019, §3.1: the cells that the paper's distance stages search.

#include "method/cell_lattice.h"

#include <algorithm>
#include <cmath>

namespace raymap {

namespace {

glm::ivec3 dimsFor(const glm::dvec3& low, const glm::dvec3& high, double size) {
  // Half a cell of margin at either end keeps rounding from losing a corner.
  return glm::max(glm::dvec3(1.0), glm::ceil((high - low) / size + 1.0));
}

}  // namespace

std::vector<CellLattice> coverMesh(const CellMesh& mesh) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      low = glm::min(low, mesh.corner(t, c));
      high = glm::max(high, mesh.corner(t, c));
    }
  return coverBounds(low, high, mesh.dims);
}

std::vector<CellLattice> coverBounds(const glm::vec3& meshLow, const glm::vec3& meshHigh,
                                     const glm::ivec3& dims) {
  std::vector<CellLattice> lattices{{dims, glm::dvec3(0.0), 1.0}};
  const glm::dvec3 low = glm::min(glm::dvec3(-0.5), glm::dvec3(meshLow));
  const glm::dvec3 high = glm::max(glm::dvec3(dims) - 0.5, glm::dvec3(meshHigh));
  if (low == glm::dvec3(-0.5) && high == glm::dvec3(dims) - 0.5) return lattices;

  const double limit = std::max(double(lattices[0].count()), 32768.0);
  double size = 1.0;
  const auto fits = [&] {
    const glm::dvec3 cells = glm::ceil((high - low) / size + 1.0);
    return cells.x * cells.y * cells.z <= limit;
  };
  while (!fits()) size *= 2.0;
  const glm::ivec3 coarse = dimsFor(low, high, size);
  lattices.push_back({coarse, 0.5 * (low + high) - 0.5 * size * glm::dvec3(coarse - 1), size});
  return lattices;
}

}  // namespace raymap
