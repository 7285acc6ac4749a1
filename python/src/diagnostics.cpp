#include <raymap/diagnostics.h>
#include <raymap/names.h>
#include <raymap/thickness.h>

#include <optional>
#include <string>

#include "call.h"
#include "diagnostics.h"

namespace raymap::python {

namespace {

nb::list listOf(const std::vector<Hole>& holes) {
  nb::list list;
  for (const Hole& hole : holes) {
    nb::dict entry;
    entry["edges"] = hole.edges;
    entry["length"] = hole.length;
    entry["area"] = hole.area;
    entry["centre"] = toList(hole.centre);
    entry["diameter"] = hole.diameter;
    list.append(entry);
  }
  return list;
}

nb::dict toDict(const Diagnostics& found) {
  nb::dict dict;
  dict["vertices"] = found.vertices;
  dict["vertices_welded"] = found.weldedVertices;
  dict["triangles"] = found.triangles;
  dict["watertight"] = found.watertight;
  dict["consistently_oriented"] = found.consistentlyOriented;
  dict["balanced"] = found.balanced;
  dict["components"] = found.components;
  dict["open_components"] = found.openComponents;
  dict["inward_components"] = found.inwardComponents;
  dict["sheets"] = found.sheets;
  dict["sheet_share"] = found.sheetShare;
  dict["boundary_edges"] = found.boundaryEdges;
  dict["hole_count"] = found.holes.size();
  dict["holes"] = listOf(found.holes);
  dict["nonmanifold_edges"] = found.nonManifoldEdges;
  dict["flipped_edges"] = found.flippedEdges;
  dict["flipped_faces"] = found.flippedFaces;
  dict["degenerate_faces"] = found.degenerateFaces;
  dict["duplicate_faces"] = found.duplicateFaces;
  dict["double_sided_faces"] = found.doubleSidedFaces;
  dict["signed_volume"] = found.signedVolume;
  dict["area"] = found.area;
  dict["bbox_min"] = toList(found.bounds.min);
  dict["bbox_max"] = toList(found.bounds.max);
  return dict;
}

nb::dict toDict(const SelfIntersections& crossings) {
  nb::dict dict;
  dict["pairs"] = crossings.pairs;
  dict["faces"] = crossings.faces.size();
  dict["complete"] = crossings.isComplete;
  return dict;
}

nb::object orNone(const std::optional<double>& value) {
  if (value) return nb::float_(*value);
  return nb::none();
}

nb::dict toDict(const Verdict& verdict) {
  nb::dict dict;
  dict["kind"] = std::string(name(verdict.kind));
  dict["remedy"] = std::string(name(verdict.remedy));
  dict["sought"] = verdict.sought;
  dict["thinnest"] = orNone(verdict.thinnest);
  dict["voxel_size"] = orNone(verdict.voxelSize);
  return dict;
}

nb::dict info(const MeshHandle& mesh, bool isFast, nb::object progress) {
  Call call(std::move(progress));
  Diagnostics found;
  std::optional<SelfIntersections> crossings;
  Verdict verdict;
  call.run([&] {
    found = diagnose(mesh.view, {.progress = call.progress()});
    if (!isFast) crossings = findSelfIntersections(mesh.view, call.progress());
    verdict = crossings ? judge(mesh.view, found, *crossings, call.progress()) : judge(found, crossings);
  });
  nb::dict dict = toDict(found);
  nb::dict uncounted;
  uncounted["counted"] = false;
  dict["self_intersections"] = crossings ? toDict(*crossings) : uncounted;
  dict["verdict"] = toDict(verdict);
  return dict;
}

}  // namespace

nb::dict describe(const Diagnostics& found, const SelfIntersections& crossings) {
  nb::dict dict = toDict(found);
  dict["self_intersections"] = toDict(crossings);
  return dict;
}

void bindDiagnostics(nb::module_& module) {
  module.def("info", &info, "mesh"_a, "fast"_a, "progress"_a.none());
}

}  // namespace raymap::python
