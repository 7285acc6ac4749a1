#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "api/field_warnings.h"
#include "base/text.h"
#include "mesh/compact.h"
#include "mesh/diagnostics.h"
#include "repair/stages.h"
#include "repair/topology/clean_faces.h"
#include "repair/topology/drop_pieces.h"
#include "repair/topology/unite_parts.h"

namespace raymap {

namespace {

/// Warns that a mesh is a sheet, unless an option says what to make of it.
void warnOfSheet(const Diagnostics& found, const RepairOptions& repair, const WarningCallback& warn) {
  const Verdict verdict = judge(found, {});
  if (verdict.remedy != Remedy::Thicken || repair.base || repair.minThickness) return;
  warn(
      {WarningCode::Sheet,
       "the mesh is a sheet, an open surface without a definite inside, so its thickness is a guess; give it "
       "one, such as " +
           numberText(verdict.thickness, 3) + ", or join its rim to a flat base",
       {.length = verdict.thickness}});
}

bool asksForChange(const RepairOptions& repair) {
  return repair.remesh || repair.offset != 0.0 || repair.shell > 0.0 ||
         repair.minThickness.value_or(0.0) > 0.0;
}

/// Keeps the faces of a mesh with nothing wrong. Drops small parts only if `RepairOptions::dropSmaller` is
/// set; warns of them else. `sources` has the given face of each of its first faces.
void keep(const Model& mesh, RepairDepth depth, RepairRun& run, std::vector<uint32_t> sources) {
  const RepairOptions& options = run.options;
  RepairReport& report = run.report;
  report.depth = depth;
  run.result = weldedCopy(mesh);
  sources.resize(mesh.triangles.size(), kNoTriangle);
  for (uint32_t& face : sources)
    if (face >= run.given.triangles.size()) face = kNoTriangle;
  Pieces found = findPieces(mesh);
  nestPieces(mesh, 1, found);
  const Choice choice = choosePieces(found, options, true, report);
  if (options.dropSmaller) {
    if (choice.count > 0) {
      size_t face = 0;
      std::erase_if(sources, [&](uint32_t) { return choice.isDropped[found.ids[face++]]; });
      dropFrom(run.result, found, choice);
    }
  } else {
    warnOfKept(report, run.machine.warn);
    report.dropped = {};
    report.dropSmaller = 0.0;
  }
  requireParts(run.result);
  run.repaired.faceSource = std::move(sources);
  if (options.triangles > 0 ? options.triangles < run.result.triangles.size()
                            : options.tolerance.value_or(0.0) > 0.0)
    simplifyResult(run, 0.0, 0.0);
  if (options.roundResult) options.roundResult(run.result);
  inspectResult(run);
}

/// Keeps the faces of a mesh that only degenerate and repeated faces make wrong, without these, and with the
/// holes and turned faces that `mend` takes back.
void keepCleaned(const Model& mesh, RepairRun& run) {
  const CleanedFaces cleaned = cleanFaces(mesh);
  if (cleaned.count == 0) return;
  const Model clean(cleaned.mesh);
  const Diagnostics found = diagnose(clean);
  if (found.nonManifoldEdges + found.degenerateFaces + found.duplicateFaces > 0) return;
  const SelfIntersections crossing = findSelfIntersections(clean);
  if (!crossesNowhere(crossing)) return;
  if (looksRight(found)) {
    if (!isRight(arrangeParts(clean, found, crossing))) return;
    keep(clean, RepairDepth::Mended, run, cleaned.given);
  } else {
    Mended& mended = run.mended;
    mended = mend(clean, found, crossing, run.fieldOptions.orientation, run.options, true);
    if (!mended.isRight) return void(mended = {});
    mended.turned = facesOf(mended.turned, cleaned.given);
    keep(Model(mended.mesh), RepairDepth::Mended, run, cleaned.given);
  }
  run.report.cleanedFaces = cleaned.count;
}

/// Keeps the faces of a mesh whose parts cross, overlap or touch: those that bound their union.
void keepUnited(RepairRun& run) {
  if (!uniteGroups(run)) return;
  KeptParts kept = std::exchange(run.kept, {});
  keep(Model(kept.mesh), RepairDepth::Mended, run, std::move(kept.sources));
  warnOfLoss(run.report.loss, run.options, run.machine.warn);
  warnOfInvertedParts(run.report.stats, run.machine.warn);
}

}  // namespace

void inspectGiven(RepairRun& run) {
  const Model mesh{MeshView(run.given)};  // Frees what it finds about the mesh.
  const RepairOptions& options = run.options;
  RepairReport& report = run.report;
  Mended& mended = run.mended;
  const bool mayKeep = !asksForChange(options);
  std::vector<uint32_t> given(mesh.triangles.size());
  std::iota(given.begin(), given.end(), 0u);
  Diagnostics found;
  SelfIntersections crossing;
  Arrangement arrangement = Arrangement::Unknown;
  if (mayKeep || options.measure || options.base) {
    inspect(mesh, found, crossing, arrangement);
    warnOfSheet(found, options, run.machine.warn);
  } else {
    found = diagnose(mesh, {.brief = true});
  }
  const bool isRightButParts = mayKeep && looksRight(found) && crossesNowhere(crossing);
  report.partsOverlap = isRightButParts && !isRight(arrangement);
  if (isRightButParts && !report.partsOverlap && !options.base)
    keep(mesh, RepairDepth::AsGiven, run, given);
  else if (mayKeep && !options.base && found.degenerateFaces + found.duplicateFaces > 0)
    keepCleaned(mesh, run);
  if (!report.keepsFaces() && (!found.watertight || !found.consistentlyOriented || options.base)) {
    mended = mend(mesh, found, crossing, run.fieldOptions.orientation, options, mayKeep);
    if (mended.isRight) keep(Model(mended.mesh), RepairDepth::Mended, run, given);
  }
  if (!report.keepsFaces()) {
    if (!mayKeep)
      report.fieldReason = FieldReason::Asked;
    else if (!crossing.complete)
      report.fieldReason = FieldReason::Crossing;
    else if (options.base)
      report.fieldReason = FieldReason::Open;
    else
      keepUnited(run);
  }
  report.closedHoles = mended.filled.holes;
  report.closingFaces = mended.filled.faces;
  report.stats.turnedFaces = mended.turned;
  if (!mayKeep && !options.measure) return;
  report.before = std::move(found);
  report.crossingBefore = std::move(crossing);
  report.arrangementBefore = arrangement;
}

}  // namespace raymap
