#include <raymap/error.h>
#include <raymap/isosurface.h>
#include <raymap/repair.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/parallel.h"
#include "base/progress.h"
#include "field/field_sampler.h"
#include "repair/deviation.h"
#include "repair/hollow.h"

namespace raymap {

namespace {

constexpr double kStep = 0.5;  // Of the points that are measured, in samples.

void check(const Grid& grid, const RepairOptions& repair) {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorCode::Usage, what);
  };
  const auto atLeast = [&](double length, const char* what) {
    require(length == 0.0 || length >= 2.0 * grid.spacing,
            std::string(what) + " of " + std::to_string(length) + " is thinner than two samples (" +
                std::to_string(2.0 * grid.spacing) + "); use more samples");
  };
  require(std::isfinite(repair.offset), "the offset must be finite");
  require(repair.shell >= 0.0 && repair.drainHole >= 0.0, "walls and holes must not be negative");
  require(repair.drainHole == 0.0 || repair.shell > 0.0, "a drain hole needs a shell: a solid has no hollow");
  require(glm::length(repair.down) > 0.0, "the way down must not be zero");
  atLeast(repair.shell, "a wall");
  atLeast(repair.drainHole, "a drain hole");
}

/// The solid with its surface moved by the offset.
Field makeSolid(const PackedMesh& mesh, const Grid& grid, const Options& options, double offset,
                Stats& stats) {
  auto [field, cost] = generate(mesh, grid, options);
  stats = std::move(cost);
  for (float& d : field.distance) d = static_cast<float>(double(d) - offset);
  return std::move(field);
}

Mesh makeSurface(const Field& solid, const Options& options) {
  return isosurface(solid, {.threads = options.threads, .warn = options.warn, .progress = options.progress});
}

void inspect(const PackedMesh& mesh, Diagnostics& found, SelfIntersections& crossing) {
  found = diagnose(mesh);
  crossing = findSelfIntersections(mesh);
}

/// Hollows that a drain hole does not fit into stay solid: nothing could leave them.
std::vector<DrainHole> hollow(Field& solid, const RepairOptions& repair, RepairReport& report) {
  if (repair.shell == 0.0) return {};
  const double radius = 0.5 * repair.drainHole;
  std::vector<DrainHole> holes;
  for (const Hollow& found : findHollows(solid, repair.shell, radius, repair.down)) {
    ++report.hollows;
    if (radius > 0.0) holes.push_back(placeHole(solid, found, radius, repair.down));
  }
  hollowOut(solid, repair.shell);
  for (const DrainHole& hole : holes) drill(solid, hole);
  report.holes = holes.size();
  return holes;
}

/// Leaves out what the drain holes made or took away.
void dropDrilled(std::vector<glm::vec3>& points, const Grid& grid, const std::vector<DrainHole>& holes) {
  std::erase_if(points, [&](const glm::vec3& p) {
    return std::ranges::any_of(
        holes, [&](const DrainHole& hole) { return hole.distance(grid.position(p)) < grid.spacing; });
  });
}

/// From the mesh's surface moved by the offset or of the hollow.
Deviation measureResult(const PackedMesh& result, const PackedMesh& mesh, const Grid& grid,
                        const RepairOptions& repair, const std::vector<DrainHole>& holes,
                        Progress& progress) {
  std::vector<glm::vec3> points = surfacePoints(result, grid, kStep);
  dropDrilled(points, grid, holes);
  std::vector<float> distances = distancesTo(mesh, grid, points, progress);
  const double outer = std::abs(repair.offset) / grid.spacing;
  const double inner = std::abs(repair.offset - repair.shell) / grid.spacing;
  for (float& d : distances)
    d = static_cast<float>(std::min(std::abs(double(d) - outer), std::abs(double(d) - inner)));
  return summarize(distances, grid.spacing);
}

enum class Side : uint8_t { Surface, Inside, Outside };

/// On which side of the mesh's solid all samples around a point lie, if they agree.
Side sideOf(const Field& solid, double offset, const glm::vec3& p) {
  const glm::ivec3 low = glm::clamp(glm::ivec3(glm::floor(p)), glm::ivec3(0), solid.grid.dims - 1);
  const glm::ivec3 high = glm::min(low + 1, solid.grid.dims - 1);
  int inside = 0;
  for (int c = 0; c < 8; ++c) {
    const glm::ivec3 s(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z);
    inside += double(solid.distance[solid.grid.index(s)]) + offset < 0.0 ? 1 : 0;
  }
  return inside == 8 ? Side::Inside : inside == 0 ? Side::Outside : Side::Surface;
}

/// The mesh's points that the result should show, and the shares of the others.
std::vector<glm::vec3> visiblePoints(const PackedMesh& mesh, const Field& solid, double offset,
                                     RepairReport& report) {
  std::vector<glm::vec3> points = surfacePoints(mesh, solid.grid, kStep);
  const auto count = double(points.size());
  size_t buried = 0, lost = 0;
  std::erase_if(points, [&](const glm::vec3& p) {
    const Side side = sideOf(solid, offset, p);
    buried += side == Side::Inside ? 1 : 0;
    lost += side == Side::Outside ? 1 : 0;
    return side != Side::Surface;
  });
  report.buriedShare = double(buried) / count;
  report.lostShare = double(lost) / count;
  return points;
}

Deviation measureMesh(std::vector<glm::vec3> points, const PackedMesh& result, const Grid& grid,
                      const RepairOptions& repair, const std::vector<DrainHole>& holes, Progress& progress) {
  dropDrilled(points, grid, holes);
  std::vector<float> distances = distancesTo(result, grid, points, progress);
  for (float& d : distances) d = std::abs(d - static_cast<float>(std::abs(repair.offset) / grid.spacing));
  return summarize(distances, grid.spacing);
}

}  // namespace

Grid fitRepairGrid(const MeshView& mesh, const GridOptions& options, const RepairOptions& repair) {
  const Box box = bounds(mesh);
  const glm::dvec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  const double room = options.padding * longest + std::max(repair.offset, 0.0);
  GridOptions covering = options;
  covering.box = Box{box.min - room, box.max + room};
  return fitGrid(mesh, covering);
}

Repaired repair(const MeshView& view, const Grid& grid, const Options& options, const RepairOptions& repair) {
  check(grid, repair);
  MeshPacker packer;
  const PackedMesh mesh = packer.pack(view);
  Repaired repaired;
  Mesh& result = repaired.mesh;
  RepairReport& report = repaired.report;
  Field solid = makeSolid(mesh, grid, options, repair.offset, report.stats);
  if (std::ranges::none_of(solid.distance, [](float d) { return d < 0.0f; }))
    throw Error(ErrorCode::Input,
                "the mesh bounds nothing that these samples see, or the offset takes all of it away; use "
                "more samples, or "
                "for a sheet 'raymap mesh --thickness'");
  std::vector<glm::vec3> points;
  if (repair.measure) points = visiblePoints(mesh, solid, repair.offset, report);
  const std::vector<DrainHole> holes = hollow(solid, repair, report);
  Progress progress(options.progress);
  progress.stage("isosurface", [&] { result = makeSurface(solid, options); });
  if (!repair.measure) return repaired;
  solid = {};
  const auto measure = [&] {
    inspect(mesh, report.before, report.crossingBefore);
    progress.report(0.1);
    inspect(result, report.after, report.crossingAfter);
    progress.part(0.2, 0.6);
    report.ofMesh = measureMesh(std::move(points), result, grid, repair, holes, progress);
    progress.part(0.6, 1.0);
    report.ofResult = measureResult(result, mesh, grid, repair, holes, progress);
  };
  progress.stage("measure", [&] { withThreads(options.threads, measure); });
  for (const Progress::Time& time : progress.times())
    report.stats.stages.push_back({time.stage, time.milliseconds});
  return repaired;
}

}  // namespace raymap
