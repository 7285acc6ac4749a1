#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/packed_mesh.h"
#include "mesh/weld.h"

namespace raymap {

/// One face's side of an edge between two distinct positions.
struct HalfEdge {
  uint32_t low, high;
  uint32_t face;
  bool isForward;  ///< Whether the face runs from `low` to `high`.

  bool isOfSameEdge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

/// Returns all half edges, those of an edge together, faces ascending. Faces with a repeated corner have
/// none.
std::vector<HalfEdge> sortHalfEdges(const PackedMesh& mesh, const Welding& welding);

/// Calls `work(halfEdges)` with the half edges of each edge.
template <class Work>
void forEachEdge(std::span<const HalfEdge> halfEdges, Work&& work) {
  for (size_t begin = 0, end = 0; begin < halfEdges.size(); begin = end) {
    while (end < halfEdges.size() && halfEdges[end].isOfSameEdge(halfEdges[begin])) ++end;
    work(halfEdges.subspan(begin, end - begin));
  }
}

}  // namespace raymap
