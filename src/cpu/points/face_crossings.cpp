#include "cpu/points/face_crossings.h"

#include "cpu/points/point_cells.h"
#include "cpu/points/prepared_surface.h"
#include "cpu/points/segment_crossings.h"
#include "mesh/triangle.h"
#include "predicates/segment_triangle.h"

namespace raymap::cpu {

int32_t countFaceCrossings(const PackedMesh& mesh, const Turns& turns, std::span<const uint32_t> faces,
                           const glm::dvec3& from, const glm::dvec3& to) {
  int32_t sum = 0;
  for (const uint32_t f : faces) {
    const uint8_t turn = turns.empty() ? kAsGiven : turns[f];
    if (turn == kLeftOut) continue;
    const auto [a, b, c] = mesh.corners(turned(mesh.triangles[f], turn));
    if (doubleAreaNormal(a, b, c) == glm::dvec3(0.0)) continue;
    const int32_t crossing = crossSegment(a, b, c, from, to);
    if (crossing == kUnsure) return kUnsure;
    sum += crossing;
  }
  return sum;
}

int32_t crossingsBetween(const PreparedSurface& surface, const glm::dvec3& from, const glm::dvec3& to,
                         std::vector<uint32_t>& faces) {
  const SurfaceTree& tree = surface.signTree();
  findTrianglesAlong(tree, toCells(surface.grid, from), toCells(surface.grid, to),
                     slackOf(tree, surface.grid.dims), faces);
  for (uint32_t& face : faces) face = tree.triangleId(face);
  const glm::dvec3& origin = surface.mesh.origin;
  return countFaceCrossings(surface.mesh, surface.turns, faces, from - origin, to - origin);
}

}  // namespace raymap::cpu
