#include <raymap/error.h>
#include <raymap/isosurface.h>
#include <raymap/repair.h>
#include <raymap/simplify.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <string>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/require.h"
#include "base/text.h"
#include "cpu/points/close_distances.h"
#include "mesh/compact.h"
#include "mesh/pieces.h"
#include "method/check_options.h"
#include "method/stage_times.h"
#include "repair/solid/deviation.h"
#include "repair/solid/given.h"
#include "repair/solid/hollow.h"
#include "repair/solid/loss.h"
#include "repair/solid/measure.h"
#include "repair/solid/thin_parts.h"
#include "repair/topology/drop_pieces.h"
#include "repair/topology/keep.h"
#include "repair/topology/mend.h"
#include "repair/warnings.h"

namespace raymap {

namespace {

/// Refuses options of a field that a solid leaves no place for.
void check(const FieldOptions& options) {
  require(options.sign != SignMode::None, "a repair needs a sign, so the sign mode must not be none");
  require(options.thickness == 0.0,
          "a repair needs a sign, so FieldOptions::thickness must be 0; for sheets use "
          "RepairOptions::minThickness");
  require(!options.invert,
          "a repair needs distances that are negative inside; leave out FieldOptions::invert");
  require(options.band == 0.0, "a repair needs distances that are not clamped; leave out FieldOptions::band");
  require(!options.closeHoles,
          "use RepairOptions::closeHoles, not FieldOptions::closeHoles: a repair closes holes");
  require(!options.winding && !options.confidence && !options.triangle,
          "a repair gives no field; leave out FieldOptions::winding, confidence and triangle");
}

void check(const Grid& grid, const RepairOptions& repair) {
  const auto atLeast = [&](double length, const char* what) {
    require(length == 0.0 || length >= 2.0 * grid.spacing,
            std::string(what) + " of " + numberText(length) + " is thinner than two samples (" +
                numberText(2.0 * grid.spacing) + "); use more samples");
  };
  require(std::isfinite(repair.offset), "the offset must be finite");
  require(std::isfinite(repair.base.value_or(0.0)), "the height of the base must be finite");
  require(repair.shell >= 0.0 && repair.drainHole >= 0.0, "walls and holes must not be negative");
  require(repair.drainHole == 0.0 || repair.shell > 0.0, "a drain hole needs a shell: a solid has no hollow");
  require(!repair.dropSmaller || (*repair.dropSmaller >= 0.0 && std::isfinite(*repair.dropSmaller)),
          "the volume below which parts are dropped must be finite and not negative");
  require(repair.drainHoles >= 1, "a hollow needs at least one drain hole, not " +
                                      std::to_string(repair.drainHoles) + "; use a drain hole of 0 for none");
  require(repair.tolerance.value_or(0.0) >= 0.0 && std::isfinite(repair.tolerance.value_or(0.0)),
          "the tolerance must not be negative");
  require(repair.triangles == 0 || repair.tolerance != 0.0,
          "a tolerance of 0 keeps all triangles, so their number cannot be limited; leave one of both out");
  require(glm::length(repair.down) > 0.0, "the way down must not be zero");
  atLeast(repair.shell, "a wall");
  atLeast(repair.drainHole, "a drain hole");
  const double least = repair.minThickness.value_or(0.0);
  require(least >= 0.0, "the least thickness must not be negative");
  require(least == 0.0 || least >= 2.0 * grid.spacing,
          "a least thickness of " + numberText(least) + " is less than two samples (" +
              numberText(2.0 * grid.spacing) + "); use a voxel size of at most " + numberText(0.5 * least));
}

/// Returns the faces that the field turns and those that were turned before it, but those that it turned
/// back.
std::vector<uint32_t> allTurned(const std::vector<uint32_t>& before, std::vector<uint32_t> byField,
                                size_t faces) {
  byField.erase(std::ranges::lower_bound(byField, uint32_t(faces)),
                byField.end());  // Faces that close holes.
  std::vector<uint32_t> all;
  std::ranges::set_symmetric_difference(before, byField, std::back_inserter(all));
  return all;
}

/// Returns the solid with its surface moved by the offset. `faces` is the number of those that were given.
Field makeSolid(Given& given, size_t faces, Stats& stats) {
  auto [field, cost] = given.generateSolid();
  cost.turnedFaces = allTurned(stats.turnedFaces, std::move(cost.turnedFaces), faces);
  stats = std::move(cost);
  for (float& d : field.distance) d = static_cast<float>(double(d) - given.repair.offset);
  return std::move(field);
}

/// Returns the field of what is left of a solid after parts of it were dropped or filled.
Field remade(const Mesh& surface, Given& given) {
  FieldOptions options = given.options;
  options.orientation = Orientation::Keep;
  return given.generateOther(surface, options);
}

void requireParts(const Mesh& surface) {
  if (surface.triangles.empty())
    throw Error(ErrorCode::Input,
                "every part is smaller than the volume below which parts are dropped; use a smaller volume");
}

bool asksForChange(const RepairOptions& repair) {
  return repair.remesh || repair.offset != 0.0 || repair.shell > 0.0 ||
         repair.minThickness.value_or(0.0) > 0.0;
}

/// Simplifies a surface, at points `step` apart, within `tolerance` if nothing else is asked for.
void simplifySurface(Mesh& surface, double step, double tolerance, const RepairOptions& repair,
                     const MachineOptions& machine, SimplifyReport& report) {
  const double asked = repair.tolerance.value_or(repair.triangles > 0 ? 0.0 : tolerance);
  report.trianglesBefore = surface.triangles.size();
  Simplified made =
      simplify(surface, {.tolerance = asked, .step = step, .triangles = repair.triangles}, machine);
  surface = std::move(made.mesh);
  report.tolerance = made.tolerance;
  report.trianglesAfter = surface.triangles.size();
  report.deviation = made.deviation;
}

/// Keeps the faces of a mesh with nothing wrong.
void keep(const PackedMesh& mesh, const RepairOptions& repair, const MachineOptions& machine,
          Repaired& repaired) {
  keepFaces(mesh, repair, machine.warn, repaired);
  RepairReport& report = repaired.report;
  requireParts(repaired.mesh);
  if (repair.triangles > 0 ? repair.triangles < repaired.mesh.triangles.size()
                           : repair.tolerance.value_or(0.0) > 0.0)
    simplifySurface(repaired.mesh, 0.0, 0.0, repair, machine, report.simplified);
  countPieces(repaired.mesh, report);
  if (repair.finish) repair.finish(repaired.mesh);
  inspect(repaired.mesh, report.after, report.crossingAfter, report.arrangementAfter);
}

/// Finds what is wrong with the given mesh, and mends what is certain. Keeps its faces if nothing is wrong
/// then. Returns the mended mesh.
Mended inspectGiven(const PackedMesh& mesh, Orientation orientation, const RepairOptions& repair,
                    const MachineOptions& machine, Repaired& repaired) {
  RepairReport& report = repaired.report;
  const bool mayKeep = !asksForChange(repair);
  Diagnostics found;
  SelfIntersections crossing;
  Arrangement arrangement = Arrangement::Unknown;
  if (mayKeep || repair.measure || repair.base) {
    inspect(mesh, found, crossing, arrangement);
    warnOfSheet(found, repair, machine.warn);
  } else {
    found = diagnose(mesh, {.brief = true});
  }
  const bool isRightButParts = mayKeep && looksRight(found) && crossesNowhere(crossing);
  report.partsOverlap = isRightButParts && !isRight(arrangement);
  Mended mended;
  if (isRightButParts && !report.partsOverlap && !repair.base)
    keep(mesh, repair, machine, repaired);
  else if (!found.watertight || !found.consistentlyOriented || repair.base)
    mended = mend(mesh, found, crossing, orientation, repair, mayKeep);
  if (mended.isRight) keep(mended.mesh, repair, machine, repaired);
  report.closedHoles = mended.filled.holes;
  report.closingFaces = mended.filled.faces;
  report.stats.turnedFaces = mended.turned;
  if (!mayKeep && !repair.measure) return mended;
  report.before = std::move(found);
  report.crossingBefore = std::move(crossing);
  report.arrangementBefore = arrangement;
  return mended;
}

bool isChanged(const RepairReport& report) {
  return report.dropped.count > 0 || report.filled.count > 0;
}

/// Finds the pieces of a surface that a choice drops, but that show surface of the mesh that no other piece
/// shows. Both are moved by the offset from each other.
std::vector<bool> findNeeded(const PackedMesh& mesh, const Mesh& surface, const Pieces& found,
                             const Choice& choice, const Grid& grid, double offset, Progress& progress) {
  const double reach = 1.0 + std::abs(offset) / grid.spacing;
  Mesh dropped = surface, rest = surface;
  dropFrom(dropped, found, opposite(choice));
  dropFrom(rest, found, choice);
  std::vector<uint32_t> pieces;  // Of the faces of `dropped`.
  for (const uint32_t p : found.ids)
    if (choice.isDropped[p]) pieces.push_back(p);
  const cpu::CloseDistances close(dropped, grid, reach * grid.spacing);
  std::vector<glm::vec3> points;
  std::vector<uint32_t> pointPieces;
  const SurfacePoints all = surfacePoints(mesh, grid, kPointStep);
  forEachPart(all.positions, grid, [&](std::span<const glm::vec3> cells, std::span<const glm::dvec3> part) {
    const QueryResult near = close.measure(part);
    for (size_t i = 0; i < part.size(); ++i)
      if (near.triangle[i] != kNoTriangle) {
        points.push_back(cells[i]);
        pointPieces.push_back(pieces[near.triangle[i]]);
      }
  });
  std::vector<bool> needed(found.pieces.size());
  const std::vector<float> distances = distancesTo(rest, grid, points, progress);
  for (size_t i = 0; i < points.size(); ++i)
    if (distances[i] > reach) needed[pointPieces[i]] = true;
  return needed;
}

/// Drops crumbs and bubbles from a solid and its surface. Returns the surface of parts that were dropped on
/// request.
Mesh dropPieces(const Given& given, Field& solid, Mesh& surface, Progress& progress, RepairReport& report) {
  const RepairOptions& repair = given.repair;
  Pieces found = findPieces(Model(surface));
  nestPieces(surface, 1, found);
  Choice choice = choosePieces(found, repair, repair.keepCavities, report);
  if (!repair.dropSmaller && report.dropped.count > 0)
    choice =
        choosePieces(found, repair, repair.keepCavities, report,
                     findNeeded(given.mesh, surface, found, choice, solid.grid, repair.offset, progress));
  warnOfRemoved(found, choice, report, [&](const Warning& warning) {
    if (repair.dropSmaller || warning.code != WarningCode::PartsDropped) given.machine.warn(warning);
  });
  if (choice.count == 0) return {};
  dropFrom(solid, surface, found, choice);
  Mesh dropped = surface;
  dropFrom(dropped, found, opposite(choice));
  dropFrom(surface, found, choice);
  requireParts(surface);
  return repair.dropSmaller ? std::move(dropped) : Mesh{};
}

/// Leaves out the lost points of parts that were dropped: no samples would keep them. Extends `bounds` by
/// them. Returns the share of the lost area that is left.
double leaveOutDropped(const Mesh& dropped, const Grid& grid, double offset, Progress& progress,
                       std::vector<FacePoint>& lost, Box& bounds) {
  if (lost.empty()) return 1.0;
  const auto area = [&] {
    return std::accumulate(lost.begin(), lost.end(), 0.0,
                           [](double sum, const FacePoint& p) { return sum + p.area; });
  };
  const double before = area();
  std::vector<glm::vec3> points;
  for (const FacePoint& p : lost) points.emplace_back((p.position - grid.origin) / grid.spacing);
  const std::vector<float> distances = distancesTo(dropped, grid, points, progress);
  const double reach = 1.0 + std::abs(offset) / grid.spacing;
  size_t k = 0;
  std::erase_if(lost, [&](const FacePoint& p) {
    if (distances[k++] > reach) return false;
    bounds.min = glm::min(bounds.min, p.position), bounds.max = glm::max(bounds.max, p.position);
    return true;
  });
  return before > 0.0 ? area() / before : 1.0;
}

/// Hollows that a drain hole does not fit into stay solid: nothing could leave them.
std::vector<DrainHole> hollow(Field& solid, const RepairOptions& repair, const WarningCallback& warn,
                              RepairReport& report) {
  const double radius = 0.5 * repair.drainHole;
  std::vector<DrainHole> holes;
  for (const Hollow& found : findHollows(solid, repair.shell, radius, repair.down, report.filledHollows)) {
    ++report.hollows;
    if (radius == 0.0) continue;
    for (const DrainHole& hole : placeHoles(solid, found, repair.drainHoles, radius, repair.down)) {
      holes.push_back(hole);
      report.drainHolePlaces.push_back(exitOf(solid, hole));
    }
  }
  hollowOut(solid, repair.shell);
  for (const DrainHole& hole : holes) drill(solid, hole);
  report.drainHoles = holes.size();
  warnOfHoles(report, repair, warn);
  return holes;
}

}  // namespace

Repaired repair(const MeshView& view, const Grid& grid, const FieldOptions& options,
                const RepairOptions& repair, const MachineOptions& asked) {
  checkOptions(grid, options);
  check(options);
  check(grid, repair);
  const Model asGiven(view);
  Repaired repaired;
  Mesh& result = repaired.mesh;
  RepairReport& report = repaired.report;
  bool isCut = false;
  MachineOptions machine = asked;
  machine.warn = [&](const Warning& warning) {
    // Repair says itself what its fields lack, and how far its result reaches.
    isCut = isCut || warning.code == WarningCode::BoxReached;
    if (warning.code == WarningCode::NothingInside || warning.code == WarningCode::BoxReached) return;
    report.warnings.push_back(warning);
    if (asked.warn) asked.warn(warning);
  };
  Progress progress(machine.progress);
  const auto stage = [&](const char* name, const auto& work) {
    progress.stage(name, [&] { withThreads(machine.threads, work); });
  };
  const auto finish = [&] {
    addStages(progress, report.stats);
    return std::move(repaired);
  };
  Mended mended;
  stage("inspect", [&] { mended = inspectGiven(asGiven, options.orientation, repair, machine, repaired); });
  if (report.kept) return finish();
  const PackedMesh mesh = mended.isChanged() ? PackedMesh(mended.mesh) : PackedMesh(asGiven);
  Given given(mesh, grid, options, repair, machine);
  Field solid = makeSolid(given, asGiven.triangles.size(), report.stats);
  report.leastThickness = leastThickness(repair, grid);
  if (report.leastThickness > 0.0) {
    stage("surface", [&] { given.surface(); });
    Thickened thickened;
    stage("thicken", [&] { thickened = thickenThinParts(given, solid, progress); });
    report.thickenedShare = thickened.share;
    warnOfThickened(mesh, thickened, repair, report.leastThickness, machine.warn);
  }
  if (std::ranges::none_of(solid.distance, [](float d) { return d < 0.0f; }))
    throw Error(ErrorCode::Input,
                "the result is empty: the mesh encloses no volume at this resolution, or the offset removes "
                "all of it; "
                "use more samples, or for a sheet a least thickness");
  stage("isosurface", [&] { result = isosurface(solid, {}, machine); });
  Mesh dropped;
  stage("pieces", [&] { dropped = dropPieces(given, solid, result, progress, report); });
  ExpectedPoints expected;
  if (repair.measure) stage("points", [&] { expected = expectedPoints(mesh, solid, repair, report); });
  std::vector<DrainHole> holes;
  if (repair.shell > 0.0) {
    if (isChanged(report)) stage("remake", [&] { solid = remade(result, given); });
    stage("hollow", [&] {
      holes = hollow(solid, repair, machine.warn, report);
      Mesh hollowed = isosurface(solid, {}, machine);
      if (repair.keepCavities) warnOfLooseBodies(result, hollowed, machine.warn);
      result = std::move(hollowed);
    });
  }
  solid = {};
  stage("simplify", [&] {
    simplifySurface(result, grid.spacing, kDefaultTolerance * grid.spacing, repair, machine,
                    report.simplified);
  });
  warnOfBounds(mesh, result, grid, repair, isCut, machine.warn);
  countPieces(result, report);
  if (repair.finish) repair.finish(result);
  if (!repair.measure) return finish();
  std::vector<FacePoint> lost;
  stage("measure",
        [&] { lost = measure(mesh, result, grid, repair, holes, std::move(expected), progress, report); });
  double share = report.lostShare;
  Box droppedBounds;
  if (!dropped.triangles.empty())
    stage("dropped",
          [&] { share *= leaveOutDropped(dropped, grid, repair.offset, progress, lost, droppedBounds); });
  if (!lost.empty() && report.leastThickness == 0.0) stage("surface", [&] { given.surface(); });
  stage("loss", [&] {
    report.loss = inspectLoss(given, lost, share, progress);
    report.loss.droppedShare = report.lostShare - share;
    report.loss.droppedBounds = droppedBounds;
  });
  warnOfLoss(report.loss, repair, machine.warn);
  return finish();
}

}  // namespace raymap
