#include "repair/topology/keep.h"

#include <algorithm>
#include <utility>

#include "mesh/compact.h"
#include "repair/topology/drop_pieces.h"

namespace raymap {

bool looksRight(const Diagnostics& found) {
  return found.watertight && found.signedVolume > 0.0 && hasOnlyHoles(found);
}

bool hasOnlyHoles(const Diagnostics& found) {
  return found.nonManifoldEdges == 0 && found.consistentlyOriented && found.degenerateFaces == 0 &&
         found.duplicateFaces == 0;
}

bool crossesNowhere(const SelfIntersections& crossing) {
  return crossing.pairs == 0 && crossing.complete;
}

void keepFaces(const PackedMesh& mesh, const RepairOptions& repair, const WarningCallback& warn,
               Repaired& repaired) {
  Pieces found = findPieces(Model(mesh));
  nestPieces(mesh, 1, found);
  RepairReport& report = repaired.report;
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
}

}  // namespace raymap
