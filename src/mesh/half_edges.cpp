#include "mesh/half_edges.h"

#include <algorithm>

namespace raymap {

namespace {

SortKey keyOf(const glm::uvec3& corners, uint32_t face, uint32_t side) {
  const uint32_t a = corners[int(side)], b = corners[int(side + 1) % 3], third = corners[int(side + 2) % 3];
  return halfEdgeKey({std::min(a, b), std::max(a, b), face, third, a < b});
}

}  // namespace

std::span<const SortKey> sortHalfEdges(const PackedMesh& mesh, const Welding& welding,
                                       Buffer<SortKey>& keys) {
  const auto cornersOf = [&](uint32_t face) {
    const glm::uvec3& t = mesh.triangles[face];
    return glm::uvec3(welding.ids[t.x], welding.ids[t.y], welding.ids[t.z]);
  };
  const std::vector<uint32_t> faces = parallelSelect(mesh.triangles.size(), [&](uint32_t face) {
    const glm::uvec3 c = cornersOf(face);
    return c.x != c.y && c.y != c.z && c.z != c.x;
  });
  const auto make = [&](size_t begin, size_t end, SortKey* to) {
    auto side = uint32_t(begin % 3);
    for (size_t k = begin; k < end; side = 0) {
      const uint32_t face = faces[k / 3];
      const glm::uvec3 corners = cornersOf(face);
      for (; side < 3 && k < end; ++side, ++k) *to++ = keyOf(corners, face, side);
    }
  };
  sortKeys(3 * faces.size(), make, keys);
  return {keys.data(), keys.size()};
}

}  // namespace raymap
