// Where a mesh has defects, for a list that a person can look through.

#include "mesh/defect_places.h"

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "mesh/disjoint_sets.h"
#include "mesh/holes.h"
#include "mesh/weld.h"

namespace raymap {

namespace {

/// Vertices of an edge, the second one twice, or of a face.
using Corners = std::array<uint32_t, 3>;

/// Groups edges or faces that share a position.
std::vector<DefectPlace> groupTouching(const PackedMesh& mesh, const Welding& welding,
                                       std::span<const Corners> elements) {
  DisjointSets sets(welding.count);
  for (const Corners& element : elements)
    for (int c = 1; c < 3; ++c) sets.link(welding.ids[element[0]], welding.ids[element[c]]);
  std::map<uint32_t, std::pair<Box, size_t>> groups;
  for (const Corners& element : elements) {
    auto& [box, count] = groups[sets.root(welding.ids[element[0]])];
    ++count;
    for (const uint32_t corner : element) {
      box.min = glm::min(box.min, mesh.position(corner));
      box.max = glm::max(box.max, mesh.position(corner));
    }
  }
  std::vector<DefectPlace> places;
  for (const auto& [root, group] : groups)
    places.push_back({group.first.centre(), glm::length(group.first.size()), group.second});
  std::ranges::stable_sort(places,
                           [](const DefectPlace& a, const DefectPlace& b) { return a.count > b.count; });
  return places;
}

std::vector<DefectPlace> placesOfHoles(const PackedMesh& mesh, const std::vector<EdgeEnds>& edges) {
  std::vector<std::pair<uint32_t, uint32_t>> ends;
  for (const EdgeEnds& edge : edges) ends.emplace_back(edge.a, edge.b);
  std::vector<DefectPlace> places;
  for (const TracedHole& traced : traceHoles(ends, [&](uint32_t v) { return mesh.position(v); }))
    places.push_back({traced.hole.centre, traced.hole.diameter, traced.hole.edges});
  return places;
}

}  // namespace

std::vector<DefectKind> findPlaces(const PackedMesh& mesh, const Defects& defects) {
  const Welding welding = weldVertices(mesh.vertices);
  std::vector<DefectKind> kinds;
  if (const size_t count = defects.boundaryEdges.size(); count > 0)
    kinds.push_back({"Holes", "edge", count, true, placesOfHoles(mesh, defects.boundaryEdges)});
  const auto add = [&](std::string_view name, std::string_view unit, const std::vector<Corners>& elements,
                       bool isComplete) {
    if (!elements.empty())
      kinds.push_back({name, unit, elements.size(), isComplete, groupTouching(mesh, welding, elements)});
  };
  std::vector<Corners> edges;
  for (const EdgeEnds& edge : defects.nonManifoldEdges) edges.push_back({edge.a, edge.b, edge.b});
  add("Edges with more than two faces", "edge", edges, true);
  const auto addFaces = [&](std::string_view name, const std::vector<uint32_t>& faces,
                            bool isComplete = true) {
    std::vector<Corners> corners;
    for (const uint32_t face : faces) {
      const glm::uvec3& t = mesh.triangles[face];
      corners.push_back({t.x, t.y, t.z});
    }
    add(name, "face", corners, isComplete);
  };
  addFaces("Faces that cross others", defects.crossedFaces, defects.isComplete);
  addFaces("Flipped faces", defects.flippedFaces);
  addFaces("Duplicate faces", defects.duplicateFaces);
  addFaces("Double-sided faces", defects.doubleSidedFaces);
  addFaces("Degenerate faces", defects.degenerateFaces);
  return kinds;
}

}  // namespace raymap
