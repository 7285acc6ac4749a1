#pragma once

// Ours: a watertight solid in place of any mesh: the whole repair on one page.

#include <raymap/isosurface.h>

#include "repair/stages.h"
#include "repair/topology/drop_pieces.h"

namespace raymap {

/// Makes the solid.
inline void makeResult(RepairRun& run) {
  const RepairOptions& options = run.options;
  RepairReport& report = run.report;

  // Finds what is wrong with the mesh, and mends what is certain: turns faces back, closes holes, joins a
  // base. If nothing is wrong then, the mesh keeps its faces.
  run.stage("inspect", [&] { inspectGiven(run); });
  if (report.keepsFaces()) return;

  // The solid: the mesh's field, moved by the offset. `generate` names the stages.
  run.makeSolid();
  report.leastThickness = leastThickness(options, run.grid);
  if (report.leastThickness > 0.0) {
    // Plates in place of what is too thin, found by queries of the prepared mesh.
    run.stage("surface", [&] { run.surface(); });
    run.stage("thicken", [&] { thickenThinParts(run); });
  }
  requireInside(run.solid);

  // Its surface, without crumbs and bubbles.
  run.stage("isosurface", [&] { run.result = isosurface(run.solid, {}, run.machine); });
  run.stage("pieces", [&] { dropPieces(run); });
  if (options.measure) run.stage("points", [&] { placeExpectedPoints(run); });
  if (options.shell > 0.0) {
    // Walls around hollows are as thick as the distances say, so these must be those of what is left.
    if (report.dropped.count + report.filled.count > 0) run.stage("remake", [&] { run.makeSolidAgain(); });
    run.stage("hollow", [&] { makeHollow(run); });
  }
  run.solid = {};

  // Fewer faces, then as the file holds them.
  const double spacing = run.grid.spacing;
  run.stage("simplify", [&] { simplifyResult(run, spacing, kDefaultTolerance * spacing); });
  roundResult(run);

  // Finds how far the result is from the mesh.
  if (options.measure) run.stage("measure", [&] { measure(run); });
  // Finds what the result lacks, and the samples that would keep it.
  if (!run.dropped.triangles.empty()) run.stage("dropped", [&] { leaveOutDropped(run); });
  if (!run.lost.empty() && report.leastThickness == 0.0) run.stage("surface", [&] { run.surface(); });
  run.stage("result", [&] {
    if (options.measure) inspectLoss(run);
    joinKept(run);
    if (options.measure)
      inspectResult(run);
    else
      countPieces(Model(run.result), report);
  });
}

/// Runs all stages that the mesh and the options ask for.
inline void runRepair(RepairRun& run) {
  makeResult(run);
  // All that was measured is about the whole solid.
  if (run.options.cutPlane) run.stage("cut", [&] { cutResult(run); });
}

}  // namespace raymap
