#include "mesh/half_edges.h"

#include <algorithm>

namespace raymap {

namespace {

constexpr SortKey kNone{UINT64_MAX, UINT64_MAX};  // Comes last: positions are below 2^32 - 1.

SortKey keyOf(const glm::uvec3& corners, uint32_t face, uint32_t side) {
  if (corners.x == corners.y || corners.y == corners.z || corners.z == corners.x) return kNone;
  const uint32_t a = corners[int(side)], b = corners[int(side + 1) % 3], third = corners[int(side + 2) % 3];
  return halfEdgeKey({std::min(a, b), std::max(a, b), face, third, a < b});
}

}  // namespace

std::span<const SortKey> sortHalfEdges(const PackedMesh& mesh, const Welding& welding,
                                       Buffer<SortKey>& keys) {
  const auto make = [&](size_t begin, size_t end, SortKey* to) {
    auto face = uint32_t(begin / 3);
    auto side = uint32_t(begin % 3);
    for (size_t k = begin; k < end; ++face, side = 0) {
      const glm::uvec3& t = mesh.triangles[face];
      const glm::uvec3 corners(welding.ids[t.x], welding.ids[t.y], welding.ids[t.z]);
      for (; side < 3 && k < end; ++side, ++k) *to++ = keyOf(corners, face, side);
    }
  };
  sortKeys(3 * mesh.triangles.size(), make, keys);
  const SortKey* none = std::partition_point(keys.data(), keys.data() + keys.size(),
                                             [](const SortKey& key) { return key.high != kNone.high; });
  return {keys.data(), none};
}

}  // namespace raymap
