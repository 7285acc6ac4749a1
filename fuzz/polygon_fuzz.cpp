// Checks that the triangles of any polygon cover its area and no more, and keep its edges. Corners lie on a
// small lattice, so that many touch edges and each other.

#include <array>
#include <cmath>
#include <cstdlib>
#include <map>

#include "mesh/polygon.h"

namespace {

using Edges = std::map<std::array<double, 4>, int>;

void require(bool holds) {
  if (!holds) std::abort();
}

void addEdge(Edges& edges, const glm::dvec3& a, const glm::dvec3& b, int count) {
  if (a == b) return;
  edges[{a.x, a.y, b.x, b.y}] += count;
  edges[{b.x, b.y, a.x, a.y}] -= count;
}

double doubleArea(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::cross(b - a, c - a).z;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::vector<glm::dvec3> corners;
  for (size_t i = 0; i < size; ++i) corners.emplace_back(data[i] % 16, data[i] / 16, 0.0);
  std::vector<glm::uvec3> triangles;
  const raymap::PolygonCut cut = raymap::cutPolygon(corners, triangles);
  if (cut == raymap::PolygonCut::None || size < 3) return 0;
  double area = 0.0, covered = 0.0;
  Edges edges;
  for (size_t c = 0; c < size; ++c) {
    addEdge(edges, corners[c], corners[(c + 1) % size], -1);
    if (c > 1) area += doubleArea(corners[0], corners[c - 1], corners[c]);
  }
  for (const glm::uvec3& t : triangles) {
    for (int c = 0; c < 3; ++c) {
      require(t[c] < size);
      addEdge(edges, corners[t[c]], corners[t[(c + 1) % 3]], 1);
    }
    const double part = doubleArea(corners[t.x], corners[t.y], corners[t.z]);
    require(part * area >= 0.0);
    covered += part;
  }
  require(covered == area);
  for (const auto& [edge, count] : edges) require(count == 0);
  return 0;
}
