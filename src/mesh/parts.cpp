#include "mesh/parts.h"

#include <algorithm>
#include <unordered_map>

#include "mesh/disjoint_sets.h"

namespace raymap {

namespace {

/// Joins the patches that have vertices in the same cell of a lattice. Its cells are `size` wide, and the
/// lattice is displaced by a share of a cell along each axis.
void joinInCells(const PackedMesh& mesh, const Patches& patches, const glm::dvec3& low, double size,
                 const glm::dvec3& displacement, DisjointSets& sets) {
  constexpr double kMostCells = 0x1FFFFF;  // 21 bits per axis.
  std::unordered_map<uint64_t, uint32_t> patchOfCell;
  for (size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 p = (mesh.position(mesh.triangles[f][c]) - low) / size + displacement;
      const glm::u64vec3 cell(glm::min(p, kMostCells));
      const auto [place, isNew] =
          patchOfCell.try_emplace(cell.x << 42 | cell.y << 21 | cell.z, patches.ids[f]);
      if (!isNew) sets.link(place->second, patches.ids[f]);
    }
}

}  // namespace

std::vector<uint32_t> findParts(const PackedMesh& mesh, const Patches& patches, double distance) {
  DisjointSets sets(patches.count);
  const glm::dvec3 low = bounds(mesh).min;
  // In one of these eight lattices, vertices closer than half a cell are in the same cell.
  for (int corner = 0; corner < 8; ++corner)
    joinInCells(mesh, patches, low, 2.0 * distance,
                0.5 * glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2), sets);
  std::vector<uint32_t> parts(patches.count);
  for (uint32_t p = 0; p < parts.size(); ++p) parts[p] = sets.root(p);
  return parts;
}

}  // namespace raymap
