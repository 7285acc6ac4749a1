#include "repair/topology/unite_parts.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include <raymap/field.h>

#include "mesh/compact.h"
#include "mesh/diagnostics.h"
#include "mesh/triangle.h"
#include "repair/topology/clean_faces.h"
#include "repair/topology/mend.h"
#include "repair/topology/settle_union.h"
#include "repair/topology/sew_cracks.h"
#include "repair/topology/thicken_sheets.h"

namespace raymap {

namespace {

constexpr double kMostSheets = 0.5;  // Share of the area. With more, they may bound a solid together.

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

/// Takes faces out of a mesh, and the same entries out of `given`.
void takeOut(const std::vector<uint32_t>& faces, Mesh& mesh, std::vector<uint32_t>& given) {
  std::vector<bool> isOut(mesh.triangles.size());
  for (const uint32_t face : faces) isOut[face] = true;
  size_t f = 0, g = 0;
  std::erase_if(mesh.triangles, [&](const glm::uvec3&) { return isOut[f++]; });
  std::erase_if(given, [&](uint32_t) { return isOut[g++]; });
}

/// Joins cracks, unless that makes faces contradict each other: rims of other parts lie there.
void sew(UnitedParts& united) {
  Mesh sewn = united.mesh;
  const size_t count = sewCracks(sewn);
  if (count == 0 ||
      diagnose(sewn, {.brief = true}).flippedEdges > diagnose(united.mesh, {.brief = true}).flippedEdges)
    return;
  united.mesh = std::move(sewn);
  united.sewnVertices = count;
}

/// Closes all holes of a part of a mesh that has an area. Returns whether that is possible. Between faces
/// that contradict each other is no hole: patches there cut grooves.
bool closeHolesOf(UnitedParts& united, double area, const Diagnostics& found) {
  constexpr double kLittle = 1e-3;  // Share of the area.
  united.filled = fillHoles(united.mesh);
  return united.filled.holes > 0 &&
         (found.consistentlyOriented || areaOfLast(united.mesh, united.filled.faces) <= kLittle * area);
}

/// Appends plates. Their faces have the given faces of their sheets.
void append(const Plates& plates, Mesh& mesh, std::vector<uint32_t>& given) {
  const auto first = uint32_t(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), plates.mesh.vertices.begin(), plates.mesh.vertices.end());
  for (const glm::uvec3& t : plates.mesh.triangles) mesh.triangles.push_back(t + first);
  given.insert(given.end(), plates.sources.begin(), plates.sources.end());
}

}  // namespace

UnitedParts uniteParts(const Model& given, InsideOut insideOut, bool closesHoles, double sheetThickness) {
  UnitedParts united{.mesh = weldedCopy(given)};
  std::vector<uint32_t> faces(united.mesh.triangles.size());  // Given face of each face.
  std::iota(faces.begin(), faces.end(), 0u);
  std::vector<uint32_t> back;  // Given faces that contradict their part.
  if (!diagnose(united.mesh, {.brief = true}).balanced) {
    CleanedFaces cleaned = cleanFaces(given);
    united.mesh = std::move(cleaned.mesh);
    faces = std::move(cleaned.given);
    united.cleanedFaces = cleaned.count;
    if (insideOut == InsideOut::Turned) back = facesOf(turnBack(united.mesh, true), faces);
    if (closesHoles) sew(united);
    Diagnostics found = diagnose(united.mesh);
    const double area = found.area;
    Plates plates;
    if (found.sheets > 0) {
      if (sheetThickness == 0.0 || found.sheetShare > kMostSheets) return {.failure = FieldReason::Sheet};
      plates = thickenSheets(united.mesh, sheetThickness);
      for (uint32_t& face : plates.sources) face = faces[face];
      united.thickenedShare = found.sheetShare;
      const std::vector<uint32_t> gone = facesOf(plates.sheets, faces);
      std::erase_if(back, [&](uint32_t face) { return std::ranges::binary_search(gone, face); });
      takeOut(plates.sheets, united.mesh, faces);
      found = diagnose(united.mesh, {.brief = true});
    }
    if (!found.balanced) {
      const bool mayClose = closesHoles && (insideOut == InsideOut::Turned || found.consistentlyOriented);
      if (!mayClose || !closeHolesOf(united, area, found)) return {.failure = FieldReason::Open};
    }
    faces.resize(united.mesh.triangles.size(), kNoTriangle);
    append(plates, united.mesh, faces);
  }
  if (insideOut == InsideOut::Turned) united.inverted = findInvertedParts(united.mesh);
  turnFaces(united.mesh, united.inverted.faces);
  SettledUnion settled = settleUnion(std::move(united.mesh), insideOut != InsideOut::Subtracted);
  if (!settled.isRight) return {.failure = FieldReason::Crossing};
  std::vector<uint32_t> inverted;
  std::ranges::set_symmetric_difference(united.inverted.faces, settled.exact.turned,
                                        std::back_inserter(inverted));
  std::ranges::set_symmetric_difference(back, facesOf(inverted, faces), std::back_inserter(united.turned));
  std::erase(united.turned, kNoTriangle);
  for (uint32_t& f : settled.sources) f = faces[f];
  united.mesh = std::move(settled.mesh);
  united.sources = std::move(settled.sources);
  united.cutFaces = settled.exact.cutFaces + settled.partedFaces;
  united.movedVertices = settled.movedVertices;
  united.buriedShare = settled.exact.buriedShare;
  return united;
}

}  // namespace raymap
