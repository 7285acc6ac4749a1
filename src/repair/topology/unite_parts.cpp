#include "repair/topology/unite_parts.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <raymap/field.h>

#include "mesh/compact.h"
#include "mesh/diagnostics.h"
#include "mesh/triangle.h"
#include "repair/topology/clean_faces.h"
#include "repair/topology/mend.h"
#include "repair/topology/settle_union.h"
#include "repair/topology/sew_cracks.h"

namespace raymap {

namespace {

/// Returns the area of the last faces of a mesh.
double areaOfLast(const Mesh& mesh, size_t count) {
  double area = 0.0;
  for (size_t f = mesh.triangles.size() - count; f < mesh.triangles.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    area += triangleArea(glm::dvec3(mesh.vertices[t.x]), glm::dvec3(mesh.vertices[t.y]),
                         glm::dvec3(mesh.vertices[t.z]));
  }
  return area;
}

}  // namespace

UnitedParts uniteParts(const Model& given, InsideOut insideOut, bool closesHoles) {
  constexpr double kLittle = 1e-3;  // Share of the area.
  UnitedParts united{.mesh = weldedCopy(given)};
  std::vector<uint32_t> faces;  // Of the given mesh, if some were left out.
  std::vector<uint32_t> back;   // Faces that contradict their part.
  if (!diagnose(united.mesh, {.brief = true}).balanced) {
    CleanedFaces cleaned = cleanFaces(given);
    united.mesh = std::move(cleaned.mesh);
    faces = std::move(cleaned.given);
    united.cleanedFaces = cleaned.count;
    bool isConsistent = diagnose(united.mesh, {.brief = true}).consistentlyOriented;
    if (!isConsistent && insideOut == InsideOut::Turned) {
      back = turnBack(united.mesh);
      isConsistent = !back.empty();
    }
    if (closesHoles) united.sewnVertices = sewCracks(united.mesh);
    if (const Diagnostics found = diagnose(united.mesh); !found.balanced) {
      if (found.sheets > 0) return {.failure = FieldReason::Sheet};
      if (closesHoles && (insideOut == InsideOut::Turned || found.consistentlyOriented))
        united.filled = fillHoles(united.mesh);
      if (united.filled.holes == 0) return {.failure = FieldReason::Open};
      // Between faces that contradict each other is no hole: patches there cut grooves.
      if (!isConsistent && areaOfLast(united.mesh, united.filled.faces) > kLittle * found.area)
        return {.failure = FieldReason::Open};
    }
  }
  if (insideOut == InsideOut::Turned) united.inverted = findInvertedParts(united.mesh);
  turnFaces(united.mesh, united.inverted.faces);
  SettledUnion settled = settleUnion(std::move(united.mesh), insideOut != InsideOut::Subtracted);
  if (!settled.isRight) return {.failure = FieldReason::Crossing};
  std::vector<uint32_t> inverted;
  std::ranges::set_symmetric_difference(united.inverted.faces, settled.exact.turned,
                                        std::back_inserter(inverted));
  std::ranges::set_symmetric_difference(back, inverted, std::back_inserter(united.turned));
  if (!faces.empty()) {
    std::erase_if(united.turned, [&](uint32_t f) { return f >= faces.size(); });
    united.turned = facesOf(united.turned, faces);
    for (uint32_t& f : settled.sources) f = f < faces.size() ? faces[f] : kNoTriangle;
  }
  united.mesh = std::move(settled.mesh);
  united.sources = std::move(settled.sources);
  united.cutFaces = settled.exact.cutFaces + settled.partedFaces;
  united.movedVertices = settled.movedVertices;
  united.buriedShare = settled.exact.buriedShare;
  return united;
}

}  // namespace raymap
