#include "mesh/surplus_faces.h"

#include <cstdlib>
#include <map>

#include "mesh/disjoint_sets.h"
#include "mesh/half_edges.h"
#include "mesh/model.h"

namespace raymap {

std::vector<uint32_t> surplusFaces(const PackedMesh& mesh, std::vector<uint32_t> repeated) {
  if (repeated.empty()) return repeated;
  const Model model(mesh);
  std::vector<bool> isRepeated(mesh.triangles.size());
  for (const uint32_t face : repeated) isRepeated[face] = true;
  // Repeated faces that share an edge are judged together.
  DisjointSets sets(mesh.triangles.size());
  struct Edge {
    uint32_t face;  // A repeated one.
    // Number of faces in one direction less those in the other: of all, and without repeated ones.
    int given, without;
  };
  std::vector<Edge> edges;
  forEachEdge(model.halfEdges(), 0, model.halfEdges().size(), [&](std::span<const SortKey> run) {
    Edge edge{UINT32_MAX, 0, 0};
    for (const SortKey& key : run) {
      const HalfEdge half = halfEdgeOf(key);
      const int side = half.isForward ? 1 : -1;
      edge.given += side;
      if (!isRepeated[half.face]) {
        edge.without += side;
      } else if (edge.face == UINT32_MAX) {
        edge.face = half.face;
      } else {
        sets.link(edge.face, half.face);
      }
    }
    if (edge.face != UINT32_MAX) edges.push_back(edge);
  });
  std::map<uint32_t, int64_t> imbalance;  // What leaving out a set adds to it.
  for (const Edge& edge : edges)
    imbalance[sets.root(edge.face)] += std::abs(edge.without) - std::abs(edge.given);
  std::erase_if(repeated, [&](uint32_t face) { return imbalance[sets.root(face)] > 0; });
  return repeated;
}

}  // namespace raymap
