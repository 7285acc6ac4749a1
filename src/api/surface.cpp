#include <raymap/names.h>
#include <raymap/surface.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "api/check_band.h"
#include "api/field_warnings.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/require.h"
#include "base/stopwatch.h"
#include "cpu/points/local_thickness.h"
#include "cpu/points/narrow_band.h"
#include "cpu/points/point_query.h"
#include "cpu/points/region.h"
#include "cpu/points/surface_pairs.h"
#include "field/field_sampler.h"
#include "mesh/model.h"
#include "mesh/triangle.h"
#include "method/points_view.h"
#include "method/pose.h"

namespace raymap {

namespace {

void check(const SurfaceOptions& options) {
  require(options.sign == SignMode::Harmonic || options.sign == SignMode::None,
          "a surface cannot use the sign '" + std::string(name(options.sign)) + "'; use harmonic or none");
  require(options.threshold >= 0.0, "the threshold must not be negative");
}

/// Throws if the options ask for what needs a sign, and there is none.
template <class Options>
void checkSigned(const Options& options, bool isSigned) {
  require(isSigned || !options.winding, "the surface was made without a sign, so it has no winding numbers");
  require(isSigned || !options.confidence,
          "the surface was made without a sign, so it has no confidence in it");
}

void check(const QueryOptions& options, bool isSigned) {
  require(options.maxDistance > 0.0, "the largest distance must be positive");
  checkSigned(options, isSigned);
}

void checkLattice(const Grid& grid) {
  for (int axis = 0; axis < 3; ++axis)
    require(grid.dims[axis] > 0 && grid.dims[axis] <= kMostDims,
            "a lattice has 1 to " + std::to_string(kMostDims) + " samples along each axis, not " +
                std::to_string(grid.dims[axis]));
  validateGrid(grid);
}

}  // namespace

void checkBand(const Grid& grid, const BandOptions& options, bool isSigned) {
  checkLattice(grid);
  require(options.outside > 0.0 && std::isfinite(options.outside),
          "the band outside must be positive and finite");
  require(options.inside > 0.0, "the band inside must be positive");
  checkSigned(options, isSigned);
}

namespace {

void check(const Grid& lattice, const Region& region, const RegionOptions& options, bool isSigned) {
  checkLattice(lattice);
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t low = region.low[axis], size = region.size[axis], dims = lattice.dims[axis];
    require(low >= 0 && size > 0 && low + size <= dims,
            "the region has " + std::to_string(size) + " samples from " + std::to_string(low) + " on along " +
                "xyz"[axis] + ", but the lattice has " + std::to_string(dims) + " from 0 on");
  }
  require(options.band >= 0.0 && std::isfinite(options.band), "the band must be finite and not negative");
  checkSigned(options, isSigned);
}

void check(const ThicknessOptions& options, std::span<const FacePoint> points, size_t triangles,
           bool isSigned) {
  require(options.maxThickness > 0.0, "the largest thickness must be positive");
  require(isSigned, "the surface was made without a sign, so it has no thickness");
  for (size_t i = 0; i < points.size(); ++i)
    if (points[i].triangle >= triangles)
      throw Error(ErrorCode::Usage, "point " + std::to_string(i) + " lies on triangle " +
                                        std::to_string(points[i].triangle) + ", but the mesh has " +
                                        std::to_string(triangles));
}

}  // namespace

struct Surface::Impl {
  Model model;
  cpu::PreparedSurface prepared;  // Refers to it.
  Stats stats;

  /// Prepares the mesh that `keep` keeps in the model.
  template <class Keep>
  void prepare(const SurfaceOptions& options, const MachineOptions& machine, Keep&& keep) {
    const Stopwatch stopwatch;
    check(options);
    Progress progress(machine.progress);
    withThreads(machine.threads, [&] {
      keep();
      validate(model);
      prepared = cpu::prepareSurface(model, options, machine, progress, stats);
      model.forget();
    });
    stats.milliseconds = stopwatch.milliseconds();
    stats.bytes = std::max(stats.bytes, bytes());
    warnOfInvertedParts(stats, machine.warn);
  }

  size_t bytes() const { return model.bytes() + prepared.bytes(); }
  /// Returns the most bytes that the surface and what a call makes may hold.
  size_t most(const MachineOptions& machine) const { return mostMemory(machine.memoryLimit, bytes()); }
};

Surface::Surface(const MeshView& view, const SurfaceOptions& options, const MachineOptions& machine)
    : impl_(std::make_unique<Impl>()) {
  notMoved(impl_).prepare(options, machine, [&] {
    if (machine.memoryLimit > 0) checkFieldMemory(Model::bytesNeeded(view), machine.memoryLimit);
    impl_->model.keep(view);
  });
}

Surface::Surface(Mesh&& mesh, const SurfaceOptions& options, const MachineOptions& machine)
    : impl_(std::make_unique<Impl>()) {
  notMoved(impl_).prepare(options, machine, [&] { impl_->model.keep(std::move(mesh)); });
}

Surface::~Surface() = default;
Surface::Surface(Surface&&) noexcept = default;
Surface& Surface::operator=(Surface&&) noexcept = default;

void Surface::query(const PointsView& points, const QueryOptions& options, QueryResult& result,
                    const MachineOptions& machine) const {
  check(options, notMoved(impl_).prepared.isSigned);
  Progress progress(machine.progress);
  withThreads(machine.threads, [&] {
    progress.stage("query",
                   [&] { cpu::queryPoints(notMoved(impl_).prepared, points, options, progress, result); });
  });
}

QueryResult Surface::query(const PointsView& points, const QueryOptions& options,
                           const MachineOptions& machine) const {
  QueryResult result;
  query(points, options, result, machine);
  return result;
}

std::vector<Thickness> Surface::thickness(std::span<const FacePoint> points, const ThicknessOptions& options,
                                          const MachineOptions& machine) const {
  check(options, points, notMoved(impl_).model.triangles.size(), notMoved(impl_).prepared.isSigned);
  Progress progress(machine.progress);
  std::vector<Thickness> thickness(points.size());
  withThreads(machine.threads, [&] {
    progress.stage("thickness", [&] {
      cpu::measureThickness(notMoved(impl_).prepared, points, options.maxThickness, progress, thickness);
    });
  });
  return thickness;
}

Field Surface::generateBand(const Grid& grid, const BandOptions& options,
                            const MachineOptions& machine) const {
  checkBand(grid, options, notMoved(impl_).prepared.isSigned);
  Progress progress(machine.progress);
  Field band;
  withThreads(machine.threads, [&] {
    band =
        cpu::makeNarrowBand(notMoved(impl_).prepared, grid, options, notMoved(impl_).most(machine), progress);
  });
  band.surfaceBounds = notMoved(impl_).prepared.bounds;
  warnOfMisfit(stats(), machine.warn);
  const bool hasInside =
      !band.narrow->tiles.empty() || std::ranges::any_of(band.distance, [](float d) { return d < 0.0f; });
  if (isSigned() && !hasInside) warnOfNothingInside(notMoved(impl_).prepared.mesh, grid, machine);
  return band;
}

Field Surface::generateRegion(const Grid& lattice, const Region& region, const RegionOptions& options,
                              const MachineOptions& machine) const {
  check(lattice, region, options, notMoved(impl_).prepared.isSigned);
  checkFieldMemory(regionBytes(region.size, options, machine), notMoved(impl_).most(machine),
                   " in one piece");
  Progress progress(machine.progress);
  Field field;
  withThreads(machine.threads,
              [&] { field = cpu::makeRegion(notMoved(impl_).prepared, lattice, region, options, progress); });
  warnOfMisfit(stats(), machine.warn);
  return field;
}

std::optional<double> Surface::farDistance(const Grid& lattice, const Region& region,
                                           const RegionOptions& options) const {
  check(lattice, region, options, notMoved(impl_).prepared.isSigned);
  std::optional<double> found;
  if (options.band > 0.0)
    withThreads(1,
                [&] { found = cpu::farDistance(notMoved(impl_).prepared, lattice, region, options.band); });
  return found;
}

size_t Surface::regionBytes(const glm::ivec3& size, const RegionOptions& options,
                            const MachineOptions& machine) const {
  return bytes() + raymap::regionBytes(size, options, machine);
}

size_t regionBytes(const glm::ivec3& size, const RegionOptions& options, const MachineOptions& machine) {
  for (int axis = 0; axis < 3; ++axis)
    require(size[axis] > 0, std::string("a region needs a sample along ") + "xyz"[axis] + ", not " +
                                std::to_string(size[axis]));
  size_t made = 0;
  withThreads(machine.threads, [&] { made = cpu::regionBytes(size, options); });
  return made;
}

Generated Surface::generate(const Grid& grid, const FieldOptions& asked,
                            const MachineOptions& machine) const {
  if (!notMoved(impl_).prepared.isSigned) return raymap::generate(mesh(), grid, asked, machine);
  FieldOptions options = asked;
  options.orientation = Orientation::Keep;
  Generated result = raymap::generate(notMoved(impl_).prepared.turnedMesh(), grid, options, machine);
  result.stats.turnedFaces = stats().turnedFaces;
  result.stats.leftOutFaces = stats().leftOutFaces;
  result.stats.invertedParts = stats().invertedParts;
  return result;
}

SurfacePair Surface::distanceTo(const Surface& other, const PairOptions& options,
                                const MachineOptions& machine) const {
  require(options.maxDistance > 0.0, "the largest distance must be positive");
  checkPose(options.pose, [] { return "the pose of the other surface"; });
  Progress progress(machine.progress);
  SurfacePair found;
  progress.stage("distance", [&] { found = closestPair(other, options, progress); });
  return found;
}

SurfacePair Surface::closestPair(const Surface& other, const PairOptions& options, Progress& progress) const {
  return cpu::closestPair(notMoved(impl_).prepared, notMoved(other.impl_).prepared, options.pose,
                          options.maxDistance, progress);
}

SurfacePair Surface::hausdorff(const Surface& other, const HausdorffOptions& options,
                               const MachineOptions& machine) const {
  require(options.tolerance >= 0.0, "the tolerance must not be negative");
  checkPose(options.pose, [] { return "the pose of the other surface"; });
  Progress progress(machine.progress);
  SurfacePair found;
  withThreads(machine.threads, [&] {
    progress.stage("distance", [&] {
      found = cpu::farthestPoint(notMoved(impl_).prepared, notMoved(other.impl_).prepared, options, progress);
    });
  });
  return found;
}

DeepestPoint Surface::deepest(const PointsView& points, const MachineOptions& machine) const {
  require(isSigned(), "the surface was made without a sign, so nothing is inside");
  DeepestPoint deepest;
  const QueryResult all = query(points, {}, machine);
  for (size_t i = 0; i < points.count; ++i)
    if (-all.distance[i] > deepest.depth) deepest = {.depth = -all.distance[i], .point = i};
  if (!(deepest.depth > 0.0)) return deepest;
  const glm::dvec3 p = pointAt(points, deepest.point);
  const QueryResult one = query(PointsView(&p.x, 1), {.closest = true, .triangle = true}, machine);
  deepest.closest = one.closest[0];
  deepest.triangle = one.triangle[0];
  return deepest;
}

bool Surface::isSigned() const {
  return notMoved(impl_).prepared.isSigned;
}

double Surface::insideReach() const {
  const cpu::PreparedSurface& prepared = notMoved(impl_).prepared;
  if (!prepared.isSigned || prepared.lattice.isWhole()) return 0.0;
  const PackedMesh& mesh = prepared.mesh;
  double area = 0.0;
  for (const glm::uvec3& face : mesh.triangles) {
    const auto [a, b, c] = mesh.corners(face);
    area += triangleArea(a, b, c);
  }
  // At a distance d from all faces, the winding number is at most area / 4 pi d^2. Half of the threshold
  // leaves room for what approximate numbers are wrong by.
  return std::sqrt(area / (2.0 * std::numbers::pi * prepared.threshold));
}

MeshView Surface::mesh() const {
  return notMoved(impl_).prepared.mesh;
}

size_t Surface::bytes() const {
  return notMoved(impl_).bytes();
}

const Stats& Surface::stats() const {
  return notMoved(impl_).stats;
}

bool isCompactBetter(const Grid& grid, size_t triangles) {
  constexpr size_t kManySamples = 1000;  // Per triangle (docs/dev/decisions/narrow_bands.md).
  return grid.sampleCount() / kManySamples < triangles;
}

}  // namespace raymap
