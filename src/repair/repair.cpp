#include <raymap/error.h>
#include <raymap/isosurface.h>
#include <raymap/repair.h>
#include <raymap/simplify.h>
#include <raymap/thickness.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/require.h"
#include "base/text.h"
#include "cpu/points/close_distances.h"
#include "mesh/compact.h"
#include "method/check_options.h"
#include "method/stage_times.h"
#include "repair/solid/deviation.h"
#include "repair/solid/given.h"
#include "repair/solid/hollow.h"
#include "repair/solid/loss.h"
#include "repair/solid/measure.h"
#include "repair/solid/thin_parts.h"
#include "repair/topology/drop_pieces.h"
#include "repair/topology/fill_holes.h"
#include "repair/topology/keep.h"
#include "repair/topology/pieces.h"

namespace raymap {

namespace {

// Samples along the longest side of a soup of faces. Its surface is mostly what closes the gaps.
constexpr int kSoupResolution = 128;
constexpr size_t kBytesPerSample = 64;  // Memory of a repair, which is at most about this much.

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

/// Returns the solid with its surface moved by the offset.
Field makeSolid(Given& given, Stats& stats) {
  auto [field, cost] = given.generateSolid();
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

bool crossesNowhere(const SelfIntersections& crossing) {
  return crossing.pairs == 0 && crossing.complete;
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
  if (!keepFaces(mesh, repair, machine.warn, repaired)) return;
  RepairReport& report = repaired.report;
  requireParts(repaired.mesh);
  if (repair.triangles > 0 ? repair.triangles < repaired.mesh.triangles.size()
                           : repair.tolerance.value_or(0.0) > 0.0)
    simplifySurface(repaired.mesh, 0.0, 0.0, repair, machine, report.simplified);
  countPieces(repaired.mesh, report);
  if (repair.finish) repair.finish(repaired.mesh);
  inspect(repaired.mesh, report.after, report.crossingAfter);
}

/// Keeps the faces of a mesh with nothing wrong but holes, and fills those, if that makes it right.
void keepFilled(const PackedMesh& mesh, const RepairOptions& repair, const MachineOptions& machine,
                Repaired& repaired) {
  Mesh closed = weldedCopy(mesh);
  const FilledHoles filled = fillHoles(closed);
  if (filled.holes == 0 || !looksRight(diagnose(closed, {.brief = true})) ||
      !crossesNowhere(findSelfIntersections(closed)))
    return;
  keep(closed, repair, machine, repaired);
  repaired.report.partsOverlap = false;
  if (!repaired.report.kept) return;
  repaired.report.closedHoles = filled.holes;
  repaired.report.closingFaces = filled.faces;
}

/// Finds what is wrong with the given mesh, and keeps its faces if that is nothing, or only holes.
void inspectGiven(const PackedMesh& mesh, const RepairOptions& repair, const MachineOptions& machine,
                  Repaired& repaired) {
  const RepairReport& report = repaired.report;
  if (asksForChange(repair) && !repair.measure) return;
  inspect(mesh, repaired.report.before, repaired.report.crossingBefore);
  if (asksForChange(repair) || !hasOnlyHoles(report.before) || !crossesNowhere(report.crossingBefore)) return;
  if (looksRight(report.before))
    keep(mesh, repair, machine, repaired);
  else if (repair.closeHoles && !report.before.watertight)
    keepFilled(mesh, repair, machine, repaired);
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
  Pieces found = findPieces(surface);
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

/// Warns of hollows and drain holes that were asked for but not made.
void warnOfHoles(const RepairReport& report, const RepairOptions& repair, const WarningCallback& warn) {
  if (const size_t filled = report.filledHollows; filled > 0)
    warn({WarningCode::HollowsFilled,
          std::to_string(filled) + (filled == 1 ? " hollow is" : " hollows are") +
              " too small for the drain hole and stayed solid; use a smaller drain hole",
          {.count = filled}});
  else if (report.hollows == 0)
    warn({WarningCode::NoHollow,
          "the solid is nowhere thick enough for a hollow inside its walls, so it has none; use thinner "
          "walls"});
  if (repair.drainHole == 0.0) return;
  if (const size_t asked = report.hollows * size_t(repair.drainHoles); report.holes < asked)
    warn({WarningCode::DrainHolesMissing,
          "only " + std::to_string(report.holes) + " of " + std::to_string(asked) +
              " drain holes were made, because the level floors of the hollows have no place for more",
          {.count = asked - report.holes}});
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
      report.holePlaces.push_back(exitOf(solid, hole));
    }
  }
  hollowOut(solid, repair.shell);
  for (const DrainHole& hole : holes) drill(solid, hole);
  report.holes = holes.size();
  warnOfHoles(report, repair, warn);
  return holes;
}

}  // namespace

RepairGrid fitRepairGrid(const MeshView& mesh, const GridOptions& options, const RepairOptions& repair,
                         const MachineOptions& machine) {
  GridOptions covering = options;
  covering.resolution = options.resolution.value_or(kRepairResolution);
  covering.box.reset();
  covering.dims.reset();
  covering.thickness = std::max({2.0 * repair.offset, repair.minThickness.value_or(0.0), 0.0});
  RepairGrid grid{fitGrid(mesh, covering)};
  if (options.resolution || options.voxelSize > 0.0) return grid;
  const Verdict verdict = judge(mesh, diagnose(mesh, {}, machine), {}, machine);
  if (verdict.kind == MeshKind::Soup) {
    covering.resolution = kSoupResolution;
    return {fitGrid(mesh, covering)};
  }
  if (!verdict.voxelSize || *verdict.voxelSize >= grid.spacing) return grid;
  grid.thinnest = verdict.thinnest;
  covering.voxelSize = *verdict.voxelSize;
  const glm::dvec3 dims = grid.spacing / covering.voxelSize * glm::dvec3(grid.dims);
  const size_t memory = machine.memoryLimit > 0 ? machine.memoryLimit : SIZE_MAX;
  if (dims.x * dims.y * dims.z <= double(std::min(memory / kBytesPerSample, kMostRepairSamples)))
    static_cast<Grid&>(grid) = fitGrid(mesh, covering);
  return grid;
}

Repaired repair(const MeshView& view, const Grid& grid, const FieldOptions& options,
                const RepairOptions& repair, const MachineOptions& asked) {
  checkOptions(grid, options);
  check(options);
  check(grid, repair);
  MeshPacker packer;
  const PackedMesh mesh = packer.pack(view);
  Repaired repaired;
  Mesh& result = repaired.mesh;
  RepairReport& report = repaired.report;
  MachineOptions machine = asked;
  machine.warn = [&](const Warning& warning) {
    if (warning.code == WarningCode::NothingInside) return;  // Repair says itself what its fields lack.
    report.warnings.push_back(warning);
    if (asked.warn) asked.warn(warning);
  };
  Given given(mesh, grid, options, repair, machine);
  Progress progress(machine.progress);
  const auto stage = [&](const char* name, const auto& work) {
    progress.stage(name, [&] { withThreads(machine.threads, work); });
  };
  const auto finish = [&] {
    addStages(progress, report.stats);
    return std::move(repaired);
  };
  stage("inspect", [&] { inspectGiven(mesh, repair, machine, repaired); });
  if (report.kept) return finish();
  Field solid = makeSolid(given, report.stats);
  report.leastThickness = leastThickness(repair, grid);
  if (report.leastThickness > 0.0) {
    stage("surface", [&] { given.surface(); });
    stage("thicken", [&] { report.thickenedShare = thickenThinParts(given, solid, progress); });
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
      result = isosurface(solid, {}, machine);
    });
  }
  solid = {};
  stage("simplify", [&] {
    simplifySurface(result, grid.spacing, kDefaultTolerance * grid.spacing, repair, machine,
                    report.simplified);
  });
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
