#include "mesh/parts.h"

#include <algorithm>
#include <span>
#include <unordered_map>

#include "base/parallel.h"
#include "mesh/disjoint_sets.h"

namespace raymap {

namespace {

constexpr uint32_t kNoPatch = UINT32_MAX;

/// Joins the patches that share a vertex. Returns a patch at each vertex, or `kNoPatch` where there is none.
std::vector<uint32_t> joinAtVertices(const PackedMesh& mesh, const Patches& patches, DisjointSets& sets) {
  std::vector<uint32_t> patchAt(mesh.vertices.size(), kNoPatch);
  for (size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int c = 0; c < 3; ++c) {
      uint32_t& patch = patchAt[mesh.triangles[f][c]];
      if (patch == kNoPatch)
        patch = patches.ids[f];
      else if (patch != patches.ids[f])
        sets.link(patch, patches.ids[f]);
    }
  return patchAt;
}

/// Joins the patches that have vertices in the same cell of a lattice. Its cells are `size` wide, and the
/// lattice is displaced by a share of a cell along each axis.
void joinInCells(const PackedMesh& mesh, std::span<const uint32_t> patchAt, const glm::dvec3& low,
                 double size, const glm::dvec3& displacement, DisjointSets& sets) {
  constexpr double kMostCells = 0x1FFFFF;  // 21 bits per axis.
  std::unordered_map<uint64_t, uint32_t> patchOfCell;
  for (uint32_t v = 0; v < patchAt.size(); ++v) {
    if (patchAt[v] == kNoPatch) continue;
    const glm::dvec3 p = (mesh.position(v) - low) / size + displacement;
    const glm::u64vec3 cell(glm::min(p, kMostCells));
    const auto [place, isNew] = patchOfCell.try_emplace(cell.x << 42 | cell.y << 21 | cell.z, patchAt[v]);
    if (!isNew) sets.link(place->second, patchAt[v]);
  }
}

std::vector<uint32_t> rootsOf(DisjointSets& sets, size_t count) {
  std::vector<uint32_t> roots(count);
  for (uint32_t p = 0; p < count; ++p) roots[p] = sets.root(p);
  return roots;
}

}  // namespace

std::vector<uint32_t> findParts(const PackedMesh& mesh, const Patches& patches, double distance) {
  DisjointSets sets(patches.count);
  const std::vector<uint32_t> patchAt = joinAtVertices(mesh, patches, sets);
  std::vector<uint32_t> parts = rootsOf(sets, patches.count);
  const auto isFirst = [](uint32_t part) { return part == 0; };
  if (std::all_of(parts.begin(), parts.end(), isFirst)) return parts;
  const glm::dvec3 low = bounds(mesh).min;
  // In one of these eight lattices, vertices closer than half a cell are in the same cell.
  parallelFor(8, 1, [&](size_t corner, size_t) {
    joinInCells(mesh, patchAt, low, 2.0 * distance,
                0.5 * glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2), sets);
  });
  return rootsOf(sets, patches.count);
}

}  // namespace raymap
