#include "repair/topology/mend.h"

#include <raymap/error.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "mesh/compact.h"
#include "mesh/defects.h"
#include "mesh/diagnostics.h"
#include "mesh/face_measures.h"
#include "mesh/patches.h"
#include "mesh/pieces.h"
#include "repair/topology/base.h"
#include "repair/topology/flat_holes.h"

namespace raymap {

namespace {

bool isClosed(const Diagnostics& found) {
  return found.watertight && found.consistentlyOriented;
}

/// Turns outermost pieces that are inside out and of which some faces were turned. Updates `turned`, which
/// has faces below `given` only.
void turnOut(Mesh& mesh, size_t given, std::vector<uint32_t>& turned) {
  if (turned.empty()) return;
  Pieces found = findPieces(Model(mesh));
  nestPieces(mesh, 1, found);
  std::vector<bool> isIn(found.pieces.size());
  for (const uint32_t face : turned) isIn[found.ids[face]] = true;
  std::vector<uint32_t> inward, others;
  for (uint32_t f = 0; f < found.ids.size(); ++f) {
    const Piece& piece = found.pieces[found.ids[f]];
    if (isIn[found.ids[f]] && piece.isCavity() && piece.around == Piece::kNone) inward.push_back(f);
  }
  turnFaces(mesh, inward);
  inward.erase(std::ranges::lower_bound(inward, uint32_t(given)), inward.end());
  std::ranges::set_symmetric_difference(turned, inward, std::back_inserter(others));
  turned = std::move(others);
}

/// Joins the mesh to the base that is asked for. Returns the faces that do.
FilledHoles addBase(Mesh& mesh, bool crossesNowhere, const RepairOptions& repair) {
  const size_t before = mesh.triangles.size();
  joinToBase(mesh, *repair.base, repair.down);
  const FilledHoles filled = fillFlatHoles(mesh);
  const bool isWhole = diagnose(mesh, {.brief = true}).boundaryEdges == 0;
  if (!isWhole || (crossesNowhere && findSelfIntersections(mesh).pairs > 0))
    throw Error(
        ErrorCode::Input,
        "no walls to a base close the mesh: its outline overlaps itself or faces of the mesh, seen along "
        "the way down; give the sheet a thickness instead");
  return {filled.holes, mesh.triangles.size() - before};
}

/// Returns whether faces are on pieces that enclose hardly anything: sheets that were closed, so both sides
/// lie on each other.
bool isAnyDoubled(const Mesh& closed, const std::vector<uint32_t>& faces) {
  constexpr double kNoVolume = 1e-3;  // Share of the area to the power of 3/2. A half ball has 0.07.
  const Model mesh(closed);
  const Pieces found = findPieces(mesh);
  std::vector<double> areas(found.pieces.size());
  forEachFaceMeasure(mesh, {}, [&](size_t f, const FaceMeasure& face) { areas[found.ids[f]] += face.area; });
  return std::ranges::any_of(faces, [&](uint32_t f) {
    const uint32_t piece = found.ids[f];
    return std::abs(found.pieces[piece].volume) < kNoVolume * std::pow(areas[piece], 1.5);
  });
}

/// Fills all holes of a mesh with no other faults. Returns nothing if that does not make it right.
std::optional<Mended> fillAll(const Mended& open, size_t given, bool hasSheets) {
  Mended mended = open;
  mended.filled = fillHoles(mended.mesh);
  if (mended.filled.holes == 0) return {};
  turnOut(mended.mesh, given, mended.turned);
  mended.isRight = isAllRight(Model(mended.mesh)) &&
                   !(hasSheets && isAnyDoubled(mended.mesh, findSheets(Model(open.mesh)).faces));
  return mended.isRight ? std::optional(std::move(mended)) : std::nullopt;
}

}  // namespace

std::vector<uint32_t> turnBack(Mesh& mesh, bool mayLeaveSome) {
  std::vector<uint32_t> turned = findFlippedFaces(findPatches(Model(mesh)), false);
  if (turned.empty()) return {};
  const size_t before = diagnose(mesh, {.brief = true}).flippedEdges;
  turnFaces(mesh, turned);
  const size_t after = diagnose(mesh, {.brief = true}).flippedEdges;
  if (after == 0 || (mayLeaveSome && after < before)) return turned;
  turnFaces(mesh, turned);
  return {};
}

bool looksRight(const Diagnostics& found, bool mayBeDegenerate) {
  return found.watertight && found.signedVolume > 0.0 && found.nonManifoldEdges == 0 &&
         found.consistentlyOriented && (mayBeDegenerate || found.degenerateFaces == 0) &&
         found.duplicateFaces == 0;
}

bool crossesNowhere(const SelfIntersections& crossing) {
  return crossing.pairs == 0 && crossing.complete;
}

bool isAllRight(const Model& mesh, SelfIntersections* crossing, bool mayBeDegenerate) {
  const Diagnostics found = diagnose(mesh, {.brief = true});
  if (!looksRight(found, mayBeDegenerate) && !crossing) return false;
  SelfIntersections pairs = findSelfIntersections(mesh);
  const bool areRight = looksRight(found, mayBeDegenerate) && crossesNowhere(pairs) &&
                        isRight(arrangeParts(mesh, found, pairs));
  if (crossing) *crossing = std::move(pairs);
  return areRight;
}

Mended mend(const Model& mesh, const Diagnostics& found, const SelfIntersections& crossing,
            Orientation orientation, const RepairOptions& repair, bool mayKeep) {
  Mended mended{.mesh = weldedCopy(mesh)};
  const size_t given = mesh.triangles.size();
  const bool isUncrossed = crossesNowhere(crossing);
  if (!found.consistentlyOriented && orientation != Orientation::Keep) mended.turned = turnBack(mended.mesh);
  if (repair.base) {
    mended.filled = addBase(mended.mesh, isUncrossed, repair);
  } else if (repair.closeHoles && !found.watertight) {
    const bool canBeRight = found.nonManifoldEdges + found.degenerateFaces + found.duplicateFaces == 0 &&
                            (found.consistentlyOriented || !mended.turned.empty());
    if (mayKeep && isUncrossed && canBeRight)
      if (std::optional<Mended> filled = fillAll(mended, given, found.sheets > 0)) return std::move(*filled);
    mended.filled = fillFlatHoles(mended.mesh);
  }
  if (!mended.turned.empty()) {
    if (!isClosed(diagnose(mended.mesh, {.brief = true})))
      return mend(mesh, found, crossing, Orientation::Keep, repair, mayKeep);
    turnOut(mended.mesh, given, mended.turned);
  }
  mended.isRight = mayKeep && isUncrossed && mended.isChanged() && isAllRight(Model(mended.mesh));
  return mended;
}

}  // namespace raymap
