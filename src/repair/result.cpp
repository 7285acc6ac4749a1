#include <raymap/simplify.h>

#include <algorithm>
#include <string>
#include <utility>

#include "base/text.h"
#include "mesh/diagnostics.h"
#include "repair/stages.h"
#include "repair/topology/cut_away.h"
#include "repair/topology/drop_pieces.h"

namespace raymap {

namespace {

/// The farthest that a mesh reaches beyond a box.
struct Overshoot {
  double length = 0.0;
  int axis = 0;
  bool isHigh = false;
};

Overshoot overshootOf(const Box& made, const Box& allowed) {
  Overshoot most;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool isHigh : {false, true})
      if (const double length =
              isHigh ? made.max[axis] - allowed.max[axis] : allowed.min[axis] - made.min[axis];
          length > most.length)
        most = {length, axis, isHigh};
  return most;
}

glm::dvec3 farthest(const Mesh& mesh, const Overshoot& excess) {
  const auto farthest = std::ranges::max_element(mesh.vertices, {}, [&](const glm::vec3& p) {
    return excess.isHigh ? p[excess.axis] : -p[excess.axis];
  });
  return mesh.origin + glm::dvec3(*farthest);
}

/// Warns of a result that leaves the mesh's bounds, moved by the offset and grown by plates, by more than two
/// samples.
void warnOfBounds(const RepairRun& run) {
  const Mesh& result = run.result;
  const bool isCut = run.isCut;
  if (result.triangles.empty()) return;
  const Box box = bounds(run.mesh());
  const double spacing = run.grid.spacing;
  const double plate = 0.5 * run.options.minThickness.value_or(0.0) + spacing;
  const double outwards = std::max(run.options.offset, 0.0), allowed = std::max(2.0 * spacing, plate);
  const Overshoot excess = overshootOf(bounds(result), {box.min - outwards, box.max + outwards});
  if (excess.length <= allowed && !isCut) return;
  const glm::dvec3 at = farthest(result, excess);
  const std::string side = std::string(excess.isHigh ? "highest " : "lowest ") + "xyz"[excess.axis];
  run.machine.warn(
      {WarningCode::BoundsLeft,
       "the result reaches " + numberText(excess.length, 3) + " beyond the mesh's " + side + ", at (" +
           numberText(at.x, 6) + ", " + numberText(at.y, 6) + ", " + numberText(at.z, 6) +
           "), where it closes a hole" +
           (isCut ? ", and would reach farther if it were not cut off there" : "") +
           "; close this hole in the mesh if it should be flat, or give open surface a thickness",
       {.length = excess.length}});
}

/// Replaces faces of a solid by the given ones that they come from. There are none if no faces were kept.
void takeSources(std::vector<uint32_t>& faces, const std::vector<uint32_t>& sources) {
  if (sources.empty()) return faces.clear();
  for (uint32_t& face : faces) face = face < sources.size() ? sources[face] : kNoTriangle;
}

}  // namespace

void simplifyResult(RepairRun& run, double step, double tolerance) {
  const RepairOptions& options = run.options;
  const double asked = options.tolerance.value_or(options.triangles > 0 ? 0.0 : tolerance);
  SimplifyReport& report = run.report.simplified;
  report.trianglesBefore = run.result.triangles.size();
  Simplified made =
      simplify(run.result, {.tolerance = asked, .step = step, .triangles = options.triangles}, run.machine);
  run.result = std::move(made.mesh);
  run.repaired.faceSource.clear();
  report.tolerance = made.tolerance;
  report.trianglesAfter = run.result.triangles.size();
  report.deviation = made.deviation;
}

void roundResult(RepairRun& run) {
  warnOfBounds(run);
  if (run.options.roundResult) run.options.roundResult(run.result);
}

void inspectResult(RepairRun& run) {
  const Model result(run.result);
  RepairReport& report = run.report;
  countPieces(result, report);
  inspect(result, report.after, report.crossingAfter, report.arrangementAfter);
}

void cutResult(RepairRun& run) {
  const Plane& plane = *run.options.cutPlane;
  Repaired& repaired = run.repaired;
  std::vector<uint32_t> sources;
  Mesh kept = cutAway(run.result, plane, sources);
  repaired.cutOff = cutAway(run.result, {-plane.normal, -plane.offset}, repaired.cutOffSource);
  takeSources(repaired.cutOffSource, repaired.faceSource);
  takeSources(sources, repaired.faceSource);
  repaired.faceSource = std::move(sources);
  run.result = std::move(kept);
  if (run.options.roundResult) run.options.roundResult(run.result);
  if (run.options.measure || run.report.keepsFaces()) return inspectResult(run);
  countPieces(Model(run.result), run.report);
}

void inspect(const Model& mesh, Diagnostics& found, SelfIntersections& crossing, Arrangement& arrangement) {
  found = diagnose(mesh);
  crossing = findSelfIntersections(mesh);
  arrangement = arrangeParts(mesh, found, crossing);
}

}  // namespace raymap
