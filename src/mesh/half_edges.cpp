#include "half_edges.h"

#include <algorithm>
#include <tuple>

#include "cpu/parallel.h"

namespace raymap {

std::vector<HalfEdge> sortHalfEdges(const Mesh& mesh, const Welding& welding) {
  std::vector<HalfEdge> halfEdges;
  halfEdges.reserve(3 * mesh.triangles.size());
  for (uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const glm::uvec3& t = mesh.triangles[face];
    const uint32_t corners[] = {welding.ids[t.x], welding.ids[t.y], welding.ids[t.z]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    for (int c = 0; c < 3; ++c) {
      const uint32_t a = corners[c], b = corners[(c + 1) % 3];
      halfEdges.push_back({std::min(a, b), std::max(a, b), face, a < b});
    }
  }
  tbb::parallel_sort(halfEdges.begin(), halfEdges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tuple(a.low, a.high, a.face) < std::tuple(b.low, b.high, b.face);
  });
  return halfEdges;
}

}  // namespace raymap
