#include "mesh/parts.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>

#include "mesh/disjoint_sets.h"

namespace raymap {

namespace {

constexpr uint32_t kNoPatch = UINT32_MAX;

/// Joins the patches that share a vertex. Returns a patch at each vertex, or `kNoPatch` where there is none.
std::vector<uint32_t> joinAtVertices(const PackedMesh& mesh, std::span<const uint32_t> faces,
                                     const Patches& patches, DisjointSets& sets) {
  std::vector<uint32_t> patchAt(mesh.vertices.size(), kNoPatch);
  for (const uint32_t f : faces)
    for (int c = 0; c < 3; ++c) {
      uint32_t& patch = patchAt[mesh.triangles[f][c]];
      if (patch == kNoPatch)
        patch = patches.ids[f];
      else if (patch != patches.ids[f])
        sets.link(patch, patches.ids[f]);
    }
  return patchAt;
}

/// Returns the cell of a lattice that a point is in. All coordinates of the point must be positive.
uint64_t cellOf(const glm::dvec3& p) {
  constexpr double kLastCell = 0x1FFFFE;  // 21 bits per axis, and all cells have neighbours.
  const glm::u64vec3 cell(glm::min(p, kLastCell));
  return cell.x << 42 | cell.y << 21 | cell.z;
}

/// Calls `work(neighbour)` for the 26 cells around a cell.
template <class Work>
void forEachNeighbour(uint64_t cell, Work&& work) {
  for (uint64_t x = 0; x < 3; ++x)
    for (uint64_t y = 0; y < 3; ++y)
      for (uint64_t z = 0; z < 3; ++z)
        if (x != 1 || y != 1 || z != 1) work(cell + ((x - 1) << 42) + ((y - 1) << 21) + (z - 1));
}

/// Returns the least coordinates of the vertices that faces use.
glm::dvec3 lowestCorner(const PackedMesh& mesh, std::span<const uint32_t> patchAt) {
  glm::vec3 low(INFINITY);
  for (size_t v = 0; v < patchAt.size(); ++v)
    if (patchAt[v] != kNoPatch) low = glm::min(low, mesh.vertices[v]);
  return glm::dvec3(low);
}

/// Joins the parts that have vertices in the same cell of a lattice or in neighbouring ones. The cells are
/// `size` wide.
void joinInCells(const PackedMesh& mesh, std::span<const uint32_t> patchAt, std::span<const uint32_t> parts,
                 double size, DisjointSets& sets) {
  const glm::dvec3 low = lowestCorner(mesh, patchAt);
  std::unordered_map<uint64_t, uint32_t> partOfCell;
  std::vector<uint32_t> cellsOf(parts.size());
  for (uint32_t v = 0; v < patchAt.size(); ++v) {
    if (patchAt[v] == kNoPatch) continue;
    const uint32_t part = parts[patchAt[v]];
    const auto [place, isNew] =
        partOfCell.try_emplace(cellOf((glm::dvec3(mesh.vertices[v]) - low) / size + 1.0), part);
    if (isNew)
      ++cellsOf[part];
    else if (place->second != part)
      sets.link(place->second, part);
  }
  const auto largest = uint32_t(std::max_element(cellsOf.begin(), cellsOf.end()) - cellsOf.begin());
  for (const auto& [cell, part] : partOfCell) {
    if (part == largest) continue;  // The other part of each pair finds it.
    forEachNeighbour(cell, [&, part = part](uint64_t neighbour) {
      if (const auto place = partOfCell.find(neighbour); place != partOfCell.end())
        sets.link(part, place->second);
    });
  }
}

std::vector<uint32_t> rootsOf(DisjointSets& sets, size_t count) {
  std::vector<uint32_t> roots(count);
  for (uint32_t p = 0; p < count; ++p) roots[p] = sets.root(p);
  return roots;
}

}  // namespace

std::vector<uint32_t> findParts(const PackedMesh& mesh, std::span<const uint32_t> faces,
                                const Patches& patches, double distance) {
  DisjointSets sets(patches.count);
  const std::vector<uint32_t> patchAt = joinAtVertices(mesh, faces, patches, sets);
  std::vector<uint32_t> parts = rootsOf(sets, patches.count);
  const auto isFirst = [](uint32_t part) { return part == 0; };
  if (std::all_of(parts.begin(), parts.end(), isFirst)) return parts;
  joinInCells(mesh, patchAt, parts, distance, sets);
  return rootsOf(sets, patches.count);
}

}  // namespace raymap
