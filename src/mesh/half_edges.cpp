#include "mesh/half_edges.h"

#include <algorithm>

#include "base/parallel.h"

namespace raymap {

namespace {

constexpr size_t kPositionsPerTask = 4096;

/// Calls `work(halfEdge)` for each half edge, faces ascending.
template <class Work>
void forEachHalfEdge(const PackedMesh& mesh, const Welding& welding, Work&& work) {
  for (uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const glm::uvec3& t = mesh.triangles[face];
    const uint32_t corners[] = {welding.ids[t.x], welding.ids[t.y], welding.ids[t.z]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    for (int c = 0; c < 3; ++c) {
      const uint32_t a = corners[c], b = corners[(c + 1) % 3];
      work(HalfEdge{std::min(a, b), std::max(a, b), face, a < b});
    }
  }
}

/// Sorts the half edges of a position by `high` and keeps the faces in order. Insertion sort handles the few
/// that a position usually has.
void sortByHigh(std::span<HalfEdge> halfEdges) {
  constexpr size_t kFew = 32;
  const auto isLower = [](const HalfEdge& a, const HalfEdge& b) { return a.high < b.high; };
  if (halfEdges.size() > kFew) return std::stable_sort(halfEdges.begin(), halfEdges.end(), isLower);
  for (auto next = halfEdges.begin(); next != halfEdges.end(); ++next)
    std::rotate(std::upper_bound(halfEdges.begin(), next, *next, isLower), next, next + 1);
}

}  // namespace

std::vector<HalfEdge> sortHalfEdges(const PackedMesh& mesh, const Welding& welding) {
  std::vector<size_t> ends(welding.count + 1, 0);  // End of each position's half edges, shifted by one.
  forEachHalfEdge(mesh, welding, [&](const HalfEdge& edge) { ++ends[edge.low + 1]; });
  for (size_t p = 1; p < ends.size(); ++p) ends[p] += ends[p - 1];
  std::vector<HalfEdge> halfEdges(ends.back());
  forEachHalfEdge(mesh, welding, [&](const HalfEdge& edge) { halfEdges[ends[edge.low]++] = edge; });
  parallelFor(welding.count, kPositionsPerTask, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const size_t first = p == 0 ? 0 : ends[p - 1];
      sortByHigh({halfEdges.data() + first, ends[p] - first});
    }
  });
  return halfEdges;
}

}  // namespace raymap
