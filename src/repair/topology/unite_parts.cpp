#include "repair/topology/unite_parts.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include <raymap/field.h>

#include "mesh/compact.h"
#include "mesh/diagnostics.h"
#include "mesh/face_measures.h"
#include "mesh/triangle.h"
#include "repair/topology/clean_faces.h"
#include "repair/topology/drop_pieces.h"
#include "repair/topology/mend.h"
#include "repair/topology/settle_union.h"
#include "repair/topology/sew_cracks.h"
#include "repair/topology/thicken_sheets.h"

namespace raymap {

namespace {

constexpr double kMostSheets = 0.5;   // Share of the area. With more, they may bound a solid together.
constexpr double kLittle = 1e-3;      // Share of the area that faces which contradict others may bound.
constexpr double kMostLost = 0.01;    // Share of the area that may be lost if it fits nowhere.
constexpr double kUnseen = 1e-6;      // Share of the area that nobody sees.
constexpr double kMostFolded = 0.05;  // Share of the sheets' area. With more, plates hide their details.

/// Returns the area of the faces of a mesh from one on.
double areaOf(const PackedMesh& mesh, size_t first = 0) {
  double area = 0.0;
  for (size_t f = first; f < mesh.triangles.size(); ++f) {
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

/// A mesh on its way to a union.
struct Preparation {
  UnitedParts& united;
  std::vector<uint32_t> faces;        ///< Given face of each face.
  std::vector<uint32_t> back = {};    ///< Given faces that contradict their part, ascending.
  std::vector<uint32_t> sheets = {};  ///< Given faces of sheets, ascending.
  double areaBeside = 0.0;            ///< Area of what the mesh was taken from.

  Mesh& mesh() { return united.mesh; }
};

/// Joins cracks up to a width, unless that makes faces contradict each other: rims of other parts lie there.
void sew(Preparation& made, double crack) {
  Mesh sewn = made.mesh();
  const size_t count = sewCracks(sewn, crack);
  if (count == 0 ||
      diagnose(sewn, {.brief = true}).flippedEdges > diagnose(made.mesh(), {.brief = true}).flippedEdges)
    return;
  std::vector<uint32_t> flat;
  for (uint32_t f = 0; f < made.faces.size(); ++f)
    if (hasRepeatedCorner(sewn.triangles[f])) flat.push_back(f);
  if (flat.size() == made.faces.size()) return;
  made.mesh() = std::move(sewn);
  made.united.sewnVertices = count;
  takeOut(flat, made.mesh(), made.faces);
}

/// Closes all holes of a part of a mesh that has an area. Returns whether that is possible. Between faces
/// that contradict each other is no hole: patches there cut grooves.
bool closeHolesOf(UnitedParts& united, double area, const Diagnostics& found) {
  united.filled = fillHoles(united.mesh);
  const size_t twisted = found.consistentlyOriented ? 0 : united.filled.twistedFaces;
  return united.filled.holes > 0 &&
         areaOf(united.mesh, united.mesh.triangles.size() - twisted) <= kLittle * area;
}

/// Appends a mesh of the same origin, and the given face of each of its faces.
void append(const Mesh& more, const std::vector<uint32_t>& sources, Mesh& mesh,
            std::vector<uint32_t>& given) {
  const auto first = uint32_t(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const glm::uvec3& t : more.triangles) mesh.triangles.push_back(t + first);
  given.insert(given.end(), sources.begin(), sources.end());
}

/// Takes the sheets out of a mesh. Returns their plates, or nothing if a field serves better.
std::optional<Plates> takeSheets(Preparation& made, const Diagnostics& found, double thickness) {
  const SheetFaces sheets = findSheets(Model(made.mesh()));
  const bool areMost = found.sheetShare * found.area > kMostSheets * (found.area + made.areaBeside);
  if (thickness == 0.0 || sheets.boundSolid || (areMost && sheets.mayBoundSolid)) return {};
  Plates plates = thickenSheets(made.mesh(), sheets.faces, thickness);
  if (plates.foldedShare > kMostFolded) return {};
  for (uint32_t& face : plates.sources) face = made.faces[face];
  made.united.thickenedShare = std::min(found.sheetShare, 1.0);
  made.sheets = facesOf(sheets.faces, made.faces);
  std::erase_if(made.back, [&](uint32_t face) { return std::ranges::binary_search(made.sheets, face); });
  takeOut(sheets.faces, made.mesh(), made.faces);
  return plates;
}

/// Makes a mesh balanced. Returns why that is not possible.
FieldReason balance(const Model& given, const UniteOptions& options, Preparation& made) {
  const bool mayTurn = options.insideOut == InsideOut::Turned;
  CleanedFaces cleaned = cleanFaces(given);
  made.mesh() = std::move(cleaned.mesh);
  made.faces = std::move(cleaned.given);
  made.united.cleanedFaces = cleaned.count;
  if (mayTurn) made.back = facesOf(turnBack(made.mesh(), true), made.faces);
  if (options.closesHoles) sew(made, options.crack > 0.0 ? options.crack : widestCrack(made.mesh()));
  Diagnostics found = diagnose(made.mesh());
  const double area = found.area;
  std::optional<Plates> plates;
  if (found.sheets > 0) {
    plates = takeSheets(made, found, options.sheetThickness);
    if (!plates) return FieldReason::Sheet;
    const bool isLeft = !made.mesh().triangles.empty();
    found = isLeft ? diagnose(made.mesh(), {.brief = true}) : Diagnostics{.balanced = true};
  }
  if (!found.balanced) {
    const bool mayClose = options.closesHoles && (mayTurn || found.consistentlyOriented);
    if (!mayClose || !closeHolesOf(made.united, area, found)) return FieldReason::Open;
  }
  made.faces.resize(made.mesh().triangles.size(), kNoTriangle);
  if (plates) append(plates->mesh, plates->sources, made.mesh(), made.faces);
  return FieldReason::None;
}

/// Fills what plates enclose where they bend or cross, if it is smaller than a cube of their thickness.
void fillBubbles(const std::vector<uint32_t>& sheets, double thickness, Mesh& mesh,
                 std::vector<uint32_t>& sources) {
  Pieces found = findPieces(Model(mesh));
  Choice choice{std::vector<bool>(found.pieces.size())};
  for (size_t p = 0; p < found.pieces.size(); ++p)
    choice.isDropped[p] = found.pieces[p].isCavity() && -found.pieces[p].volume < std::pow(thickness, 3);
  for (size_t f = 0; f < sources.size(); ++f)
    if (!std::ranges::binary_search(sheets, sources[f])) choice.isDropped[found.ids[f]] = false;
  if (std::ranges::count(choice.isDropped, true) == 0) return;
  nestPieces(mesh, 1, found);
  for (const Piece& piece : found.pieces)
    if (piece.around != Piece::kNone) choice.isDropped[piece.around] = false;
  size_t face = 0;
  std::erase_if(sources, [&](uint32_t) { return choice.isDropped[found.ids[face++]]; });
  dropFrom(mesh, found, choice);
}

/// Does what `uniteParts` does for faces with one side. Sets what the exact union is.
UnitedParts uniteSides(const Model& given, const UniteOptions& options, UnitedFaces& exact,
                       double areaBeside = 0.0) {
  UnitedParts united{.mesh = weldedCopy(given)};
  Preparation made{united, std::vector<uint32_t>(given.triangles.size())};
  std::iota(made.faces.begin(), made.faces.end(), 0u);
  made.areaBeside = areaBeside;
  if (!diagnose(united.mesh, {.brief = true}).balanced)
    if (const FieldReason reason = balance(given, options, made); reason != FieldReason::None)
      return {.failure = reason};
  if (options.insideOut == InsideOut::Turned) united.inverted = findInvertedParts(united.mesh);
  turnFaces(united.mesh, united.inverted.faces);
  SettledUnion settled = settleUnion(std::move(united.mesh), options.insideOut != InsideOut::Subtracted);
  if (!settled.isRight) united.failure = FieldReason::Crossing;
  std::vector<uint32_t> inverted;
  std::ranges::set_symmetric_difference(united.inverted.faces, settled.exact.turned,
                                        std::back_inserter(inverted));
  std::ranges::set_symmetric_difference(made.back, facesOf(inverted, made.faces),
                                        std::back_inserter(united.turned));
  std::erase(united.turned, kNoTriangle);
  for (std::vector<uint32_t>* sources :
       {&settled.sources, &settled.exact.sources, &settled.exact.openSources})
    for (uint32_t& f : *sources) f = made.faces[f];
  united.mesh = std::move(settled.mesh);
  united.sources = std::move(settled.sources);
  if (!made.sheets.empty()) fillBubbles(made.sheets, options.sheetThickness, united.mesh, united.sources);
  united.cutFaces = settled.exact.cutFaces + settled.partedFaces;
  united.cleanedFaces += settled.exact.repeatedFaces;
  united.movedVertices = settled.movedVertices;
  united.buriedShare = settled.exact.buriedShare;
  exact = std::move(settled.exact);
  return united;
}

/// Adds what was done before to a mesh whose faces come from `sources`, and from `open` faces of its sheets.
void add(const UnitedParts& before, const UnitedParts& open, const std::vector<uint32_t>& sources,
         UnitedParts& united) {
  std::vector<uint32_t> turned;
  std::ranges::set_symmetric_difference(before.turned, facesOf(united.turned, sources),
                                        std::back_inserter(turned));
  united.turned = std::move(turned);
  std::erase(united.turned, kNoTriangle);
  for (uint32_t& f : united.sources) f = sources[f];
  united.inverted = before.inverted;
  united.thickenedShare = before.thickenedShare;
  for (const UnitedParts* more : {&before, &open}) {
    united.cutFaces += more->cutFaces;
    united.cleanedFaces += more->cleanedFaces;
    united.sewnVertices += more->sewnVertices;
    united.movedVertices += more->movedVertices;
    united.buriedShare += more->buriedShare;
    united.filled = {more->filled.holes + united.filled.holes, more->filled.faces + united.filled.faces};
  }
}

}  // namespace

UnitedParts uniteParts(const Model& given, const UniteOptions& options) {
  UnitedFaces exact, rest;
  UnitedParts parts = uniteSides(given, options, exact);
  if (exact.open.triangles.empty() || options.insideOut == InsideOut::Subtracted) return parts;
  const double all = areaOf(given), area = areaOf(exact.open), beside = all - 2.0 * area;
  if (area <= kUnseen * all) return parts;
  // Both sides of sheets, or of solids, lie on each other.
  UnitedParts open = uniteSides(Model(exact.open), options, rest, beside);
  if (open.failure != FieldReason::None) {
    parts.lostShare = 2.0 * area / all;
    parts.lostBounds = bounds(exact.open);
    return parts.lostShare <= kMostLost ? parts : open;
  }
  parts.thickenedShare += open.thickenedShare * area / (beside + area);
  for (uint32_t& f : open.sources)
    if (f != kNoTriangle) f = exact.openSources[f];
  append(open.mesh, open.sources, exact.mesh, exact.sources);
  UnitedParts united = uniteSides(Model(exact.mesh), {.insideOut = options.insideOut}, rest);
  add(parts, open, exact.sources, united);
  return united;
}

}  // namespace raymap
