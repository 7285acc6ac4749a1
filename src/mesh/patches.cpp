#include "mesh/patches.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "mesh/disjoint_sets.h"
#include "mesh/half_edges.h"

namespace raymap {

namespace {

/// Disjoint sets of faces (union by index, path halving). Each face has a bit: whether it is reversed against
/// its parent.
class FaceSets {
 public:
  explicit FaceSets(Buffer<uint32_t> parents) : parent_(std::move(parents)), isReversed_(parent_.size(), 0) {}

  struct Place {
    uint32_t root;
    uint8_t isReversed;
  };
  Place find(uint32_t face) {
    uint8_t isReversed = 0;
    while (parent_[face] != face) {
      const uint32_t up = parent_[face];
      isReversed_[face] ^= isReversed_[up];  // The root's bit is 0.
      isReversed ^= isReversed_[face];
      face = parent_[face] = parent_[up];
    }
    return {face, isReversed};
  }

  /// Links two faces that point to the same side, or to opposite sides. Does nothing if they are linked.
  /// Returns whether the faces are linked as asked.
  bool link(uint32_t a, uint32_t b, bool areOpposite) {
    const Place p = find(a), q = find(b);
    const auto isReversed = uint8_t(p.isReversed ^ q.isReversed ^ uint8_t(areOpposite));
    const auto [low, high] = std::minmax(p.root, q.root);
    if (low == high) return isReversed == 0;
    parent_[high] = low;
    isReversed_[high] = isReversed;
    return true;
  }

 private:
  Buffer<uint32_t> parent_;
  std::vector<uint8_t> isReversed_;
};

/// Two faces that share an edge of exactly two faces.
struct Link {
  uint32_t a, b;
  bool areOpposite;
};

/// Returns whether two faces at one edge share the third corner too: they are layers, not neighbours.
bool coincide(const Model& mesh, const HalfEdge& a, const HalfEdge& b) {
  const auto allCorners = [&](uint32_t face) {
    const glm::uvec3 c = weldedFace(mesh, mesh.welding(), face);
    return c.x ^ c.y ^ c.z;
  };
  return a.thirdBits == b.thirdBits && allCorners(a.face) == allCorners(b.face);
}

/// Calls `work(link)` for the edges that begin in [begin, end).
template <class Work>
void forEachLink(const Model& mesh, size_t begin, size_t end, Work&& work) {
  forEachEdge(mesh.halfEdges(), begin, end, [&](std::span<const SortKey> edge) {
    if (edge.size() != 2) return;
    const HalfEdge a = halfEdgeOf(edge[0]), b = halfEdgeOf(edge[1]);
    if (!coincide(mesh, a, b)) work(Link{a.face, b.face, a.isForward == b.isForward});
  });
}

Buffer<uint32_t> faceRoots(DisjointSets& sets, size_t count) {
  Buffer<uint32_t> roots(count);
  parallelFor(count, kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) roots[f] = sets.root(uint32_t(f));
  });
  return roots;
}

/// Links in order. Of links that contradict each other, the last one is dropped.
FaceSets linkInOrder(const Model& mesh) {
  DisjointSets single(mesh.triangles.size());
  FaceSets sets(faceRoots(single, mesh.triangles.size()));
  forEachLink(mesh, 0, mesh.halfEdges().size(),
              [&](const Link& link) { sets.link(link.a, link.b, link.areOpposite); });
  return sets;
}

/// Links with all threads. If no links contradict each other, as usual, their order does not matter: those of
/// faces that point to the same side come first, because they need no bits.
FaceSets linkFaces(const Model& mesh) {
  const std::span<const SortKey> halfEdges = mesh.halfEdges();
  std::vector<std::vector<Link>> opposite((halfEdges.size() + kCheapGrain - 1) / kCheapGrain);
  DisjointSets alike(mesh.triangles.size());
  parallelFor(opposite.size(), 1, [&](size_t task, size_t) {
    const size_t begin = task * kCheapGrain, end = std::min(begin + kCheapGrain, halfEdges.size());
    forEachLink(mesh, begin, end, [&](const Link& link) {
      if (link.areOpposite)
        opposite[task].push_back(link);
      else
        alike.link(link.a, link.b);
    });
  });
  FaceSets sets(faceRoots(alike, mesh.triangles.size()));
  for (const std::vector<Link>& links : opposite)
    for (const Link& link : links)
      if (!sets.link(link.a, link.b, true)) return linkInOrder(mesh);
  return sets;
}

}  // namespace

Patches findPatches(const Model& mesh) {
  FaceSets sets = linkFaces(mesh);
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
