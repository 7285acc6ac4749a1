#include "repair/topology/sew_cracks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mesh/compact.h"
#include "mesh/disjoint_sets.h"
#include "mesh/half_edges.h"

namespace raymap {

namespace {

// Vertices that are farther apart are no two sides of a crack.
constexpr double kShare = 0.25;   // Share of the shortest edge on a rim.
constexpr double kWidest = 2e-3;  // Share of the mesh's diagonal.
constexpr size_t kMostTests = size_t{1} << 26;
/// Vertices are sorted along this direction: rims often lie in planes across an axis.
const glm::dvec3 kAlong(0.36, 0.48, 0.8);
constexpr uint32_t kNone = UINT32_MAX;

/// A vertex on a rim.
struct RimVertex {
  glm::dvec3 place;
  double along;
  uint32_t vertex;
  double reach;              ///< How far its other half may lie.
  uint32_t nearest = kNone;  ///< Number of the nearest one.
  double distance = INFINITY;
};

/// Returns the vertices on rims, in their order along `kAlong`.
std::vector<RimVertex> rimVertices(const Mesh& mesh, double widest) {
  std::vector<double> reach(mesh.vertices.size(), INFINITY);
  Buffer<SortKey> keys;
  const std::span<const SortKey> halfEdges = sortHalfEdges(mesh, unwelded(mesh.vertices.size()), keys);
  forEachEdge(halfEdges, 0, halfEdges.size(), [&](std::span<const SortKey> edge) {
    if (edge.size() != 1) return;
    const HalfEdge only = halfEdgeOf(edge[0]);
    const double length =
        glm::distance(glm::dvec3(mesh.vertices[only.low]), glm::dvec3(mesh.vertices[only.high]));
    for (const uint32_t v : {only.low, only.high}) reach[v] = std::min(reach[v], kShare * length);
  });
  std::vector<RimVertex> found;
  for (uint32_t v = 0; v < reach.size(); ++v)
    if (reach[v] < INFINITY)
      found.push_back({glm::dvec3(mesh.vertices[v]), glm::dot(kAlong, glm::dvec3(mesh.vertices[v])), v,
                       std::min(reach[v], widest)});
  std::ranges::stable_sort(found, {}, &RimVertex::along);
  return found;
}

/// Returns false if that takes too much work.
bool findNearest(std::vector<RimVertex>& rims) {
  size_t tests = 0;
  const auto take = [&](uint32_t a, uint32_t b, double distance) {
    if (distance >= rims[a].distance) return;
    rims[a].nearest = b;
    rims[a].distance = distance;
  };
  for (uint32_t a = 0; a < rims.size(); ++a)
    for (uint32_t b = a + 1; b < rims.size() && rims[b].along - rims[a].along <= rims[a].reach; ++b) {
      if (++tests > kMostTests) return false;
      const double distance = glm::distance(rims[a].place, rims[b].place);
      if (distance > std::min(rims[a].reach, rims[b].reach)) continue;
      take(a, b, distance);
      take(b, a, distance);
    }
  return true;
}

/// Joins pairs once. Returns how many vertices went.
size_t sewOnce(Mesh& mesh, double widest) {
  std::vector<RimVertex> rims = rimVertices(mesh, widest);
  if (!findNearest(rims)) return 0;
  std::vector<uint32_t> joined(mesh.vertices.size(), kNone);
  size_t count = 0;
  for (uint32_t a = 0; a < rims.size(); ++a) {
    const uint32_t b = rims[a].nearest;
    if (b == kNone || rims[b].nearest != a || b < a) continue;
    const auto [low, high] = std::minmax(rims[a].vertex, rims[b].vertex);
    joined[high] = low;
    ++count;
  }
  for (glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c)
      if (joined[t[c]] != kNone) t[c] = joined[t[c]];
  return count;
}

}  // namespace

size_t sewCracks(Mesh& mesh, double widest) {
  size_t count = 0;
  while (const size_t more = sewOnce(mesh, widest)) count += more;  // Several patches may meet at a place.
  if (count > 0) removeUnusedVertices(mesh);
  return count;
}

double widestCrack(const MeshView& mesh) {
  return kWidest * glm::length(bounds(mesh).size());
}

}  // namespace raymap
