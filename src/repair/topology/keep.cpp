#include "repair/topology/keep.h"

#include <algorithm>
#include <utility>

#include "mesh/compact.h"
#include "repair/topology/drop_pieces.h"

namespace raymap {

namespace {

constexpr size_t kRaysPerPiece = 64;

/// Returns whether the winding number is 0 or 1 everywhere: outermost pieces are solids, and pieces in others
/// are cavities in solids or solids in cavities.
bool areNestedRight(const Pieces& found) {
  return found.areApart && std::ranges::all_of(found.pieces, [&](const Piece& piece) {
           const bool isInSolid = piece.around != Piece::kNone && !found.pieces[piece.around].isCavity();
           return piece.isCavity() == isInSolid;
         });
}

}  // namespace

bool looksRight(const Diagnostics& found) {
  return found.watertight && found.signedVolume > 0.0 && hasOnlyHoles(found);
}

bool hasOnlyHoles(const Diagnostics& found) {
  return found.nonManifoldEdges == 0 && found.consistentlyOriented && found.degenerateFaces == 0 &&
         found.duplicateFaces == 0;
}

bool keepFaces(const PackedMesh& mesh, const RepairOptions& repair, const WarningCallback& warn,
               Repaired& repaired) {
  Pieces found = findPieces(mesh);
  nestPieces(mesh, kRaysPerPiece, found);
  RepairReport& report = repaired.report;
  report.partsOverlap = !areNestedRight(found);
  if (report.partsOverlap) return false;
  report.kept = true;
  repaired.mesh = weldedCopy(mesh);
  const Choice choice = choosePieces(found, repair, true, report);
  if (repair.dropSmaller) {
    if (choice.count > 0) dropFrom(repaired.mesh, found, choice);
  } else {
    warnOfKept(report, warn);
    report.dropped = {};
    report.dropSmaller = 0.0;
  }
  return true;
}

}  // namespace raymap
