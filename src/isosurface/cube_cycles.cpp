#include "isosurface/cube_cycles.h"

#include <algorithm>

namespace raymap {

namespace {

bool isAmbiguous(unsigned corners, const CubeFace& face) {
  return std::ranges::all_of(face.edges, [&](int edge) { return isEdgeCrossed(corners, edge); });
}

/// Disjoint sets of edges.
class EdgeSets {
 public:
  void join(int a, int b) {
    const int from = of_[b], to = of_[a];
    std::ranges::replace(of_, from, to);
  }
  int of(int edge) const { return of_[edge]; }

 private:
  std::array<int, kCubeEdges> of_{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
};

/// Joins a face's crossed edges in pairs, because the surface leaves each face that it enters.
void joinAcross(const CubeFace& face, unsigned corners, bool joined, EdgeSets& sets) {
  if (isAmbiguous(corners, face)) {
    // Cuts off corners 1 and 3, or else 0 and 2.
    const int first = isCornerInside(corners, face.corners[1]) != joined ? 0 : 1;
    sets.join(face.edges[first], face.edges[first + 1]);
    sets.join(face.edges[first + 2], face.edges[(first + 3) % 4]);
    return;
  }
  int before = -1;
  for (const int edge : face.edges) {
    if (!isEdgeCrossed(corners, edge)) continue;
    if (before >= 0) sets.join(before, edge);
    before = edge;
  }
}

}  // namespace

unsigned ambiguousFaces(unsigned corners) {
  unsigned faces = 0;
  for (int f = 0; f < kCubeFaces; ++f) faces |= (isAmbiguous(corners, kCubeFaceTable[f]) ? 1u : 0u) << f;
  return faces;
}

CubeCycles::CubeCycles(unsigned corners, unsigned joined) {
  EdgeSets sets;
  for (int f = 0; f < kCubeFaces; ++f) joinAcross(kCubeFaceTable[f], corners, (joined >> f & 1) != 0, sets);
  std::array<int, kCubeEdges> number;
  number.fill(-1);
  int count = 0;
  for (int edge = 0; edge < kCubeEdges; ++edge) {
    if (!isEdgeCrossed(corners, edge)) continue;
    int& n = number[sets.of(edge)];
    if (n < 0) n = count++;
    bits_ |= static_cast<uint32_t>(n) << 2 * edge;
  }
  bits_ |= static_cast<uint32_t>(count) << kCountShift;
}

bool CubeCycles::passTwice(int face) const {
  const CubeFace& f = kCubeFaceTable[face];
  return of(f.edges[0]) == of(f.edges[1]) && of(f.edges[0]) == of(f.edges[2]) &&
         of(f.edges[0]) == of(f.edges[3]);
}

}  // namespace raymap
