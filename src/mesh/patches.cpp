#include "mesh/patches.h"

#include <algorithm>
#include <numeric>

#include "mesh/half_edges.h"

namespace raymap {

namespace {

/// Disjoint sets of faces (union by index, path halving). Each face has a bit: whether it is reversed against
/// its parent.
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
      isReversed_[face] ^= isReversed_[up];  // The root's bit is 0.
      isReversed ^= isReversed_[face];
      face = parent_[face] = parent_[up];
    }
    return {face, isReversed};
  }

  /// Links two faces that point to the same side, or to opposite sides. Does nothing if they are linked.
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

/// Returns whether two faces at one edge share the third corner too: they are layers, not neighbours.
bool coincide(const PackedMesh& mesh, const Welding& welding, const HalfEdge& a, const HalfEdge& b) {
  const auto allCorners = [&](uint32_t face) {
    const glm::uvec3& t = mesh.triangles[face];
    return welding.ids[t.x] ^ welding.ids[t.y] ^ welding.ids[t.z];
  };
  return allCorners(a.face) == allCorners(b.face);
}

}  // namespace

Patches findPatches(const PackedMesh& mesh) {
  const Welding welding = weldVertices(mesh.vertices);
  FaceSets sets(mesh.triangles.size());
  forEachEdge(sortHalfEdges(mesh, welding), [&](std::span<const HalfEdge> edge) {
    if (edge.size() == 2 && !coincide(mesh, welding, edge[0], edge[1]))
      sets.link(edge[0].face, edge[1].face, edge[0].isForward == edge[1].isForward);
  });
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
