#include <raymap/error.h>
#include <raymap/isosurface.h>
#include <raymap/repair.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/parallel.h"
#include "base/progress.h"
#include "repair/hollow.h"
#include "repair/measure.h"

namespace raymap {

namespace {

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
  ExpectedPoints expected;
  if (repair.measure) expected = expectedPoints(mesh, solid, repair, report);
  const std::vector<DrainHole> holes = hollow(solid, repair, report);
  Progress progress(options.progress);
  progress.stage("isosurface", [&] { result = makeSurface(solid, options); });
  if (!repair.measure) return repaired;
  solid = {};
  progress.stage("measure", [&] {
    withThreads(options.threads,
                [&] { measure(mesh, result, grid, repair, holes, std::move(expected), progress, report); });
  });
  for (const Progress::Time& time : progress.times())
    report.stats.stages.push_back({time.stage, time.milliseconds});
  return repaired;
}

}  // namespace raymap
