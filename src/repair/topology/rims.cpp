#include "repair/topology/rims.h"

#include <algorithm>

#include "mesh/half_edges.h"
#include "mesh/loops.h"

namespace raymap {

namespace {

/// Returns the edges of rims, by their first vertex.
std::vector<BorderEdge> findBorderEdges(const Mesh& mesh, BorderEdges which) {
  Buffer<SortKey> keys;
  const std::span<const SortKey> halfEdges = sortHalfEdges(mesh, unwelded(mesh.vertices.size()), keys);
  std::vector<BorderEdge> edges;
  forEachEdge(halfEdges, 0, halfEdges.size(), [&](std::span<const SortKey> edge) {
    if (which == BorderEdges::OneFace && edge.size() != 1) return;
    int surplus = 0;
    for (const SortKey& key : edge) surplus += halfEdgeOf(key).isForward ? 1 : -1;
    for (const SortKey& key : edge) {
      const HalfEdge side = halfEdgeOf(key);
      if (surplus == 0 || side.isForward != (surplus > 0)) continue;
      surplus += surplus > 0 ? -1 : 1;
      const glm::uvec3& t = mesh.triangles[side.face];
      edges.push_back({side.to(), side.from(), t.x ^ t.y ^ t.z ^ side.low ^ side.high});
    }
  });
  std::ranges::sort(edges, {}, &BorderEdge::from);
  return edges;
}

}  // namespace

Rims findRims(const Mesh& mesh, BorderEdges which) {
  const std::vector<BorderEdge> edges = findBorderEdges(mesh, which);
  std::vector<bool> isUsed(edges.size());
  const auto take = [&](uint32_t& place) {
    auto e = size_t(std::ranges::lower_bound(edges, place, {}, &BorderEdge::from) - edges.begin());
    while (e < edges.size() && edges[e].from == place && isUsed[e]) ++e;
    if (e == edges.size() || edges[e].from != place) return kNoEdge;
    isUsed[e] = true;
    place = edges[e].to;
    return uint32_t(e);
  };
  std::vector<uint32_t> starts;
  for (const BorderEdge& edge : edges) starts.push_back(edge.from);
  Rims rims;
  traceLoops(mesh.vertices.size(), starts, take, [&](std::span<const LoopStep> steps, uint32_t end) {
    if (end != steps[0].from) return rims.open.push_back(end);
    Rim& rim = rims.closed.emplace_back();
    for (const LoopStep& step : steps) rim.push_back(edges[step.edge]);
  });
  return rims;
}

}  // namespace raymap
