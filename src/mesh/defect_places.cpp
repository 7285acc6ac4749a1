// Places of a mesh's defects, for a list that a person can look through.

#include <raymap/diagnostics.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "base/parallel.h"
#include "mesh/defects.h"
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

DefectList listEdges(const PackedMesh& mesh, const Welding& welding, Defect defect, std::string_view name,
                     const std::vector<EdgeEnds>& edges) {
  DefectList list{.defect = defect, .name = name};
  std::vector<Corners> corners;
  for (const EdgeEnds& edge : edges) {
    list.edges.emplace_back(edge.a, edge.b);
    corners.push_back({edge.a, edge.b, edge.b});
  }
  list.places = defect == Defect::Hole ? placesOfHoles(mesh, edges) : groupTouching(mesh, welding, corners);
  return list;
}

DefectList listFaces(const PackedMesh& mesh, const Welding& welding, Defect defect, std::string_view name,
                     std::vector<uint32_t> faces) {
  std::vector<Corners> corners;
  for (const uint32_t face : faces) {
    const glm::uvec3& t = mesh.triangles[face];
    corners.push_back({t.x, t.y, t.z});
  }
  return {.defect = defect,
          .name = name,
          .faces = std::move(faces),
          .places = groupTouching(mesh, welding, corners)};
}

std::vector<DefectList> listAll(const Model& mesh, Defects found) {
  const Welding& welding = mesh.welding();
  std::vector<DefectList> lists;
  const auto addEdges = [&](Defect defect, std::string_view name, const std::vector<EdgeEnds>& edges) {
    if (!edges.empty()) lists.push_back(listEdges(mesh, welding, defect, name, edges));
  };
  const auto addFaces = [&](Defect defect, std::string_view name, std::vector<uint32_t>& faces) {
    if (!faces.empty()) lists.push_back(listFaces(mesh, welding, defect, name, std::move(faces)));
  };
  addEdges(Defect::Hole, "Holes", found.boundaryEdges);
  addEdges(Defect::NonManifoldEdge, "Edges with more than two faces", found.nonManifoldEdges);
  addFaces(Defect::CrossedFace, "Faces that cross others", found.crossedFaces);
  addFaces(Defect::FlippedFace, "Flipped faces", found.flippedFaces);
  addFaces(Defect::DuplicateFace, "Duplicate faces", found.duplicateFaces);
  addFaces(Defect::DoubleSidedFace, "Double-sided faces", found.doubleSidedFaces);
  addFaces(Defect::DegenerateFace, "Degenerate faces", found.degenerateFaces);
  for (DefectList& list : lists)
    if (list.defect == Defect::CrossedFace) list.complete = found.isComplete;
  return lists;
}

}  // namespace

std::vector<DefectList> findDefectPlaces(const MeshView& view, const MachineOptions& machine) {
  const Model mesh(view);
  std::vector<DefectList> lists;
  withThreads(machine.threads, [&] { lists = listAll(mesh, findDefects(mesh, machine.progress)); });
  return lists;
}

}  // namespace raymap
