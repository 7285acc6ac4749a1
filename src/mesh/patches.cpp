#include "patches.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <utility>

#include "cpu/parallel.h"
#include "weld.h"

namespace raymap {

namespace {

/// One face's side of an edge between two welded vertices.
struct HalfEdge {
  uint32_t low, high;
  uint32_t face : 31;
  uint32_t isForward : 1;  ///< Whether the face walks from the lower vertex to the higher one.

  std::pair<uint32_t, uint32_t> ends() const { return {low, high}; }
  bool operator<(const HalfEdge& other) const {
    return std::tuple(low, high, face) < std::tuple(other.low, other.high, other.face);
  }
};

/// Disjoint sets of faces, each face with a bit against its set's root (union by index, paths halved).
class FaceSets {
 public:
  explicit FaceSets(size_t count) : parent_(count), isReversed_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  struct Place {
    uint32_t root;
    uint8_t isReversed;
  };
  Place find(uint32_t face) {
    uint8_t isReversed = 0;
    while (parent_[face] != face) {
      const uint32_t up = parent_[face];
      isReversed_[face] ^= isReversed_[up];  // 0 at a root
      isReversed ^= isReversed_[face];
      face = parent_[face] = parent_[up];
    }
    return {face, isReversed};
  }

  /// Links two faces that point to the same side, or to opposite ones, unless they are linked already.
  void link(uint32_t a, uint32_t b, bool areOpposite) {
    const Place p = find(a), q = find(b);
    const auto [low, high] = std::minmax(p.root, q.root);
    parent_[high] = low;
    if (low != high) isReversed_[high] = uint8_t(p.isReversed ^ q.isReversed ^ uint8_t(areOpposite));
  }

 private:
  std::vector<uint32_t> parent_;
  std::vector<uint8_t> isReversed_;
};

/// The half edges of all faces, in order of their edges. Those between equal corners are no edges.
std::vector<HalfEdge> sortedHalfEdges(const Mesh& mesh, const Welding& welding) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (uint32_t face = 0; face < mesh.triangles.size(); ++face)
    for (int c = 0; c < 3; ++c) {
      const uint32_t a = welding.ids[mesh.triangles[face][c]];
      const uint32_t b = welding.ids[mesh.triangles[face][(c + 1) % 3]];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), face & 0x7fffffffu, a < b ? 1u : 0u});
    }
  tbb::parallel_sort(edges.begin(), edges.end());
  return edges;
}

/// Whether both faces have the same three corners: layers, not neighbours.
bool coincide(const Mesh& mesh, const Welding& welding, uint32_t a, uint32_t b) {
  const auto corners = [&](uint32_t face) {
    const glm::uvec3& t = mesh.triangles[face];
    std::array<uint32_t, 3> ids{welding.ids[t.x], welding.ids[t.y], welding.ids[t.z]};
    std::sort(ids.begin(), ids.end());
    return ids;
  };
  return corners(a) == corners(b);
}

}  // namespace

Patches findPatches(const Mesh& mesh) {
  const Welding welding = weldVertices(mesh.vertices);
  const std::vector<HalfEdge> edges = sortedHalfEdges(mesh, welding);
  FaceSets sets(mesh.triangles.size());
  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].ends() == edges[begin].ends()) ++end;
    const HalfEdge &a = edges[begin], &b = edges[end - 1];
    if (end - begin == 2 && !coincide(mesh, welding, a.face, b.face))
      sets.link(a.face, b.face, a.isForward == b.isForward);
  }
  Patches patches{.ids = std::vector<uint32_t>(mesh.triangles.size()),
                  .isReversed = std::vector<uint8_t>(mesh.triangles.size())};
  for (uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const FaceSets::Place place = sets.find(face);
    // A root is the lowest face of its set, so its number is known by now.
    patches.ids[face] = place.root == face ? static_cast<uint32_t>(patches.count++) : patches.ids[place.root];
    patches.isReversed[face] = place.isReversed;
  }
  return patches;
}

}  // namespace raymap
