#include "method/orientation_surface.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"
#include "mesh/half_edges.h"
#include "mesh/position_bits.h"

namespace raymap {

namespace {

/// Counts the edges at which the double-sided faces of each patch end.
/// The half edges are those of the faces that are taken.
std::vector<Borders> findBorders(std::span<const SortKey> halfEdges, const OrientationSurface& surface) {
  std::vector<Borders> borders(surface.patches.count);
  const auto faceOf = [&](const SortKey& key) { return surface.taken[halfEdgeOf(key).face]; };
  const auto isDirected = [&](const SortKey& key) { return surface.isDirected[faceOf(key)] != 0; };
  forEachEdge(halfEdges, 0, halfEdges.size(), [&](std::span<const SortKey> edge) {
    const auto directed = std::count_if(edge.begin(), edge.end(), isDirected);
    for (const SortKey& key : edge) {
      if (isDirected(key)) continue;
      Borders& ofPatch = borders[surface.patches.ids[faceOf(key)]];
      if (edge.size() == 1) ++ofPatch.open;
      if (edge.size() > 2) ++ofPatch.branching;
      if (directed > 0) ++(directed % 2 == 1 ? ofPatch.closing : ofPatch.dividing);
    }
  });
  return borders;
}

/// Returns the surface of the faces that are taken. The others have no patch yet.
OrientationSurface surfaceOf(const PackedMesh& given, Turns asGiven, std::vector<uint8_t> isDirected) {
  const size_t count = given.triangles.size();
  std::vector<uint32_t> taken =
      parallelSelect(count, [&](uint32_t face) { return asGiven[face] != kLeftOut; });
  std::vector<glm::uvec3> faces;
  faces.reserve(taken.size());
  for (const uint32_t face : taken) faces.push_back(given.triangles[face]);
  const Model mesh(PackedMesh(given.vertices, faces, given.origin));
  const Patches patches = findPatches(mesh);
  OrientationSurface surface{
      .taken = std::move(taken),
      .asGiven = std::move(asGiven),
      .isDirected = std::move(isDirected),
      .patches = {std::vector<uint32_t>(count), std::vector<uint8_t>(count), patches.count},
      .areas = std::vector<float>(count),
      .patchAreas = std::vector<double>(patches.count),
      .borders = {}};
  for (size_t t = 0; t < faces.size(); ++t) {
    const uint32_t face = surface.taken[t], patch = patches.ids[t];
    const glm::vec3 a = mesh.vertices[faces[t].x];
    const glm::vec3 across = glm::cross(mesh.vertices[faces[t].y] - a, mesh.vertices[faces[t].z] - a);
    surface.patches.ids[face] = patch;
    surface.patches.isReversed[face] = patches.isReversed[t];
    surface.areas[face] = glm::length(across);
    surface.patchAreas[patch] += surface.areas[face];
    surface.area += surface.areas[face];
  }
  const std::vector<uint8_t>& directed = surface.isDirected;
  if (std::find(directed.begin(), directed.end(), 0) != directed.end())
    surface.borders = findBorders(mesh.halfEdges(), surface);
  return surface;
}

}  // namespace

size_t OrientationSurface::patchCount() const {
  return size_t(std::count_if(patchAreas.begin(), patchAreas.end(), [](double a) { return a > 0.0; }));
}

Turns OrientationSurface::aligned() const {
  Turns turns = asGiven;
  for (const uint32_t f : taken)
    if (patches.isReversed[f]) turns[f] = kReversed;
  return turns;
}

OrientationSurface takeAllFaces(const PackedMesh& mesh, Turns given) {
  return surfaceOf(mesh, std::move(given), std::vector<uint8_t>(mesh.triangles.size(), 1));
}

OrientationSurface takeSingleFaces(const PackedMesh& mesh, const DoubleSidedFaces& doubleSided) {
  std::vector<uint8_t> isDirected(mesh.triangles.size(), 1);
  for (const uint32_t face : doubleSided.others) isDirected[face] = 0;
  for (const uint32_t face : doubleSided.firsts) isDirected[face] = 0;
  OrientationSurface surface =
      surfaceOf(mesh, withoutOthers(doubleSided, mesh.triangles.size()), std::move(isDirected));
  std::vector<uint32_t>& ids = surface.patches.ids;
  for (size_t o = 0; o < doubleSided.others.size(); ++o)
    ids[doubleSided.others[o]] = ids[doubleSided.firsts[doubleSided.groupOf[o]]];
  return surface;
}

Turns withoutRepeated(const DoubleSidedFaces& doubleSided, size_t faceCount) {
  Turns turns(faceCount, kAsGiven);
  for (const uint32_t face : doubleSided.repeated) turns[face] = kLeftOut;
  return turns;
}

Turns withoutOthers(const DoubleSidedFaces& doubleSided, size_t faceCount) {
  Turns turns = withoutRepeated(doubleSided, faceCount);
  for (const uint32_t face : doubleSided.others) turns[face] = kLeftOut;
  return turns;
}

std::optional<Turns> turnsOfFirsts(const DoubleSidedFaces& doubleSided, Turns turns, size_t faceCount) {
  if (doubleSided.empty()) return turns;
  if (turns.empty()) turns.assign(faceCount, kAsGiven);
  const std::vector<uint32_t>&others = doubleSided.others, &groupOf = doubleSided.groupOf;
  for (size_t o = 0; o < others.size(); ++o) {
    const uint8_t first = turns[doubleSided.firsts[groupOf[o]]], other = turns[others[o]];
    if (o > 0 && groupOf[o] == groupOf[o - 1] && other != turns[others[o - 1]]) return {};
    if (other != kLeftOut && (other != kAsGiven || first != kAsGiven)) return {};
  }
  for (size_t o = 0; o < others.size(); ++o)
    if (turns[others[o]] == kAsGiven) turns[doubleSided.firsts[groupOf[o]]] = kLeftOut;
  return turns;
}

namespace {

/// Positions, not exactly: a position that was added is found, and few others are.
class PositionFilter {
 public:
  explicit PositionFilter(size_t positions) : bits_(std::bit_ceil(std::max<size_t>(16 * positions, 64))) {}
  void add(const glm::vec3& p) { bits_[slotOf(p)] = true; }
  bool has(const glm::vec3& p) const { return bits_[slotOf(p)]; }

 private:
  size_t slotOf(const glm::vec3& p) const { return hashOf(p) >> 32 & (bits_.size() - 1); }
  std::vector<bool> bits_;
};

/// Returns the faces with two or more corners at the positions, ascending.
std::vector<uint32_t> facesAt(const PackedMesh& mesh, const PositionFilter& positions) {
  return parallelSelect(mesh.triangles.size(), [&](uint32_t face) {
    int known = 0;
    for (int c = 0; c < 3; ++c) known += positions.has(mesh.vertices[mesh.triangles[face][c]]) ? 1 : 0;
    return known >= 2;
  });
}

/// The double-sided faces and those that share an edge with them, and a few more, as a mesh of its own. No
/// face of it is repeated.
struct Surroundings {
  Mesh mesh = {};
  DoubleSidedFaces doubleSided = {};
};

Surroundings surroundingsOf(const PackedMesh& mesh, const DoubleSidedFaces& doubleSided) {
  PositionFilter positions(3 * doubleSided.firsts.size());
  for (const uint32_t face : doubleSided.firsts)
    for (int c = 0; c < 3; ++c) positions.add(mesh.vertices[mesh.triangles[face][c]]);
  Surroundings result{.doubleSided = doubleSided};
  result.doubleSided.repeated.clear();
  const Turns taken = withoutRepeated(doubleSided, mesh.triangles.size());
  std::vector<uint32_t> newIndex(mesh.triangles.size());
  for (const uint32_t f : facesAt(mesh, positions)) {
    if (taken[f] == kLeftOut) continue;
    newIndex[f] = uint32_t(result.mesh.triangles.size());
    const auto first = uint32_t(result.mesh.vertices.size());
    for (int c = 0; c < 3; ++c) result.mesh.vertices.push_back(mesh.vertices[mesh.triangles[f][c]]);
    result.mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  for (std::vector<uint32_t>* list : {&result.doubleSided.firsts, &result.doubleSided.others})
    for (uint32_t& face : *list) face = newIndex[face];
  return result;
}

}  // namespace

DoubleSidedFaces withoutSheets(const PackedMesh& mesh, const DoubleSidedFaces& doubleSided,
                               double leastArea) {
  if (doubleSided.count() == mesh.triangles.size()) return doubleSided;  // Nothing else is there.
  const Surroundings near = surroundingsOf(mesh, doubleSided);
  const OrientationSurface surface = takeSingleFaces(near.mesh, near.doubleSided);
  std::vector<double> areas(
      surface.patches.count);  // Twice the area of the double-sided faces in each patch.
  for (const uint32_t face : near.doubleSided.firsts) areas[surface.patches.ids[face]] += surface.areas[face];
  DoubleSidedFaces kept;
  kept.repeated = doubleSided.repeated;
  std::vector<uint32_t> newGroup(doubleSided.firsts.size(), UINT32_MAX);
  for (size_t g = 0; g < newGroup.size(); ++g) {
    const uint32_t patch = surface.patches.ids[near.doubleSided.firsts[g]];
    const Borders& ofPatch = surface.borders[patch];
    if (ofPatch.dividing > ofPatch.closing) continue;
    if (areas[patch] < leastArea && ofPatch.open + ofPatch.closing > 0) continue;
    newGroup[g] = uint32_t(kept.firsts.size());
    kept.firsts.push_back(doubleSided.firsts[g]);
  }
  for (size_t o = 0; o < doubleSided.others.size(); ++o) {
    if (newGroup[doubleSided.groupOf[o]] == UINT32_MAX) continue;
    kept.others.push_back(doubleSided.others[o]);
    kept.groupOf.push_back(newGroup[doubleSided.groupOf[o]]);
  }
  return kept;
}

}  // namespace raymap
