#include <raymap/error.h>
#include <raymap/surface.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <tuple>

#include "api/run_on_cpu.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "cpu/points/local_thickness.h"
#include "cpu/points/point_query.h"
#include "cpu/points/rims.h"
#include "mesh/packed_mesh.h"

namespace raymap {

namespace {

/// Samples along the longest side of the lattice that knows the inside. About 16 triangles of an even mesh
/// touch each of its cells at the surface, within these limits.
int latticeResolution(size_t triangles) {
  constexpr double kFewest = 64.0, kMost = 96.0;
  return static_cast<int>(std::clamp(std::sqrt(double(triangles)) / 4.0, kFewest, kMost));
}

/// Farthest distance that the lattice needs to know, in samples. Points are closer to their cell's corners.
constexpr double kLatticeBand = 3.0;

void check(const SurfaceOptions& options) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw Error(ErrorCode::Usage, what);
  };
  require(options.threads >= 0, "the number of threads must not be negative");
  require(options.threshold >= 0.0, "the threshold must not be negative");
}

void check(const QueryOptions& options, bool isSigned) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw Error(ErrorCode::Usage, what);
  };
  require(options.threads >= 0, "the number of threads must not be negative");
  require(options.maxDistance > 0.0, "the largest distance must be positive");
  require(isSigned || !options.winding,
          "the surface was made without a sign, so it knows no winding numbers");
  require(isSigned || !options.confidence,
          "the surface was made without a sign, so it has no confidence in it");
}

void check(const ThicknessOptions& options, std::span<const FacePoint> points, size_t triangles,
           bool isSigned) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw Error(ErrorCode::Usage, what);
  };
  require(options.threads >= 0, "the number of threads must not be negative");
  require(options.most > 0.0, "the largest thickness must be positive");
  require(isSigned, "the surface was made without a sign, so it has no thickness");
  for (size_t i = 0; i < points.size(); ++i)
    if (points[i].triangle >= triangles)
      throw Error(ErrorCode::Usage, "point " + std::to_string(i) + " lies on triangle " +
                                        std::to_string(points[i].triangle) + ", but the mesh has " +
                                        std::to_string(triangles));
}

}  // namespace

struct Surface::Impl {
  Buffer<glm::vec3> vertices;
  Buffer<glm::uvec3> triangles;
  Buffer<glm::uvec3> turnedTriangles;  // as the sign takes them; empty: as given
  cpu::PreparedSurface prepared;
  Stats stats;

  void copy(const MeshView& view, size_t memoryLimit) {
    if (memoryLimit > 0) checkFieldMemory(MeshPacker::bytesNeeded(view), memoryLimit);
    MeshPacker packer;
    const PackedMesh mesh = packer.pack(view);
    validate(mesh);
    vertices.resizeUninitialized(mesh.vertices.size());
    triangles.resizeUninitialized(mesh.triangles.size());
    std::ranges::copy(mesh.vertices, vertices.begin());
    std::ranges::copy(mesh.triangles, triangles.begin());
    prepared.mesh = {vertices, triangles, mesh.origin};
  }

  size_t meshBytes() const {
    return vertices.capacityBytes() + triangles.capacityBytes() + turnedTriangles.capacityBytes();
  }

  /// Builds the tree alone.
  void prepareUnsigned(Progress& progress) {
    progress.stage("tree", [&] {
      CellMesh cells;
      toCellUnits(prepared.mesh, prepared.grid, cells);
      prepared.tree.buildSingleSided(cells, prepared.mesh.vertices);
    });
    for (const Progress::Time& time : progress.times())
      stats.stages.push_back({time.stage, time.milliseconds});
    stats.device = "cpu";
  }

  /// Makes a field on the lattice, and keeps what points need of it.
  void prepareSigned(const SurfaceOptions& options, Progress& progress) {
    Options field;
    field.orientation = options.orientation;
    field.threshold = options.threshold;
    field.threads = options.threads;
    field.memoryLimit = options.memoryLimit;
    field.winding = field.confidence = true;
    field.band = kLatticeBand;
    cpu::Backend backend;
    Field samples;
    stats = runOnCpu(backend, {prepared.mesh, prepared.grid, field, progress, samples}, meshBytes());
    progress.stage("tree", [&] { keep(backend, samples); });
    stats.stages.push_back({"tree", progress.times().back().milliseconds});
  }

  void keep(cpu::Backend& backend, Field& samples) {
    cpu::WindingLattice& lattice = prepared.lattice;
    lattice.grid = prepared.grid;
    lattice.isNearRim = cpu::markRims(backend.cellMesh());
    lattice.distance = std::move(samples.distance);
    const auto scale = static_cast<float>(1.0 / prepared.grid.spacing);
    for (float& distance : lattice.distance) distance = std::abs(distance) * scale;
    lattice.winding = std::move(samples.winding);
    lattice.confidence = std::move(samples.confidence);
    prepared.turns = backend.faceSides().turns;
    std::tie(prepared.tree, prepared.dipoles) = backend.takeTree();
    prepared.isSigned = true;
    turnFaces();
    if (prepared.turnedTree || !prepared.dipoles.isPrepared()) prepared.dipoles.prepare(prepared.signTree());
  }

  /// Builds a tree of the faces as the sign takes them, if that differs from the other tree.
  void turnFaces() {
    const Turns& turns = prepared.turns;
    const bool isAsGiven = std::ranges::all_of(turns, [](uint8_t turn) { return turn == kAsGiven; });
    if (isAsGiven && prepared.tree.triangleCount() == triangles.size()) {
      prepared.turns.clear();
      return;
    }
    turnedTriangles.resizeUninitialized(triangles.size());
    for (size_t f = 0; f < triangles.size(); ++f)
      turnedTriangles[f] = turned(triangles[f], turns.empty() ? kAsGiven : turns[f]);
    CellMesh cells;
    toCellUnits({vertices, turnedTriangles, prepared.mesh.origin}, prepared.grid, cells);
    prepared.turnedTree.emplace().build(cells);
  }
};

Surface::Surface(const MeshView& view, const SurfaceOptions& options) : impl_(std::make_unique<Impl>()) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  check(options);
  Progress progress(options.progress);
  withThreads(options.threads, [&] {
    impl_->copy(view, options.memoryLimit);
    impl_->prepared.threshold = options.threshold;
    impl_->prepared.grid =
        fitGrid(impl_->prepared.mesh, {.resolution = latticeResolution(impl_->triangles.size())});
    if (options.sign)
      impl_->prepareSigned(options, progress);
    else
      impl_->prepareUnsigned(progress);
  });
  impl_->stats.totalMilliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  impl_->stats.bytes = std::max(impl_->stats.bytes, bytes());
}

Surface::~Surface() = default;
Surface::Surface(Surface&&) noexcept = default;
Surface& Surface::operator=(Surface&&) noexcept = default;

void Surface::query(const PointsView& points, const QueryOptions& options, QueryResult& result) const {
  check(options, impl_->prepared.isSigned);
  Progress progress(options.progress);
  withThreads(options.threads, [&] {
    progress.stage("query", [&] { cpu::queryPoints(impl_->prepared, points, options, progress, result); });
  });
}

QueryResult Surface::query(const PointsView& points, const QueryOptions& options) const {
  QueryResult result;
  query(points, options, result);
  return result;
}

std::vector<Thickness> Surface::thickness(std::span<const FacePoint> points,
                                          const ThicknessOptions& options) const {
  check(options, points, impl_->triangles.size(), impl_->prepared.isSigned);
  Progress progress(options.progress);
  std::vector<Thickness> thickness(points.size());
  withThreads(options.threads, [&] {
    progress.stage("thickness", [&] {
      cpu::measureThickness(impl_->prepared, points, options.most, progress, thickness);
    });
  });
  return thickness;
}

Generated Surface::generate(const Grid& grid, const Options& asked) const {
  PackedMesh mesh = impl_->prepared.mesh;
  if (!impl_->prepared.isSigned) return raymap::generate(mesh, grid, asked);
  Options options = asked;
  options.orientation = Orientation::Keep;
  if (!impl_->turnedTriangles.empty()) mesh.triangles = impl_->turnedTriangles;
  Generated result = raymap::generate(mesh, grid, options);
  result.stats.turnedFaces = stats().turnedFaces;
  result.stats.leftOutFaces = stats().leftOutFaces;
  return result;
}

MeshView Surface::mesh() const {
  return impl_->prepared.mesh;
}

size_t Surface::bytes() const {
  return impl_->meshBytes() + impl_->prepared.bytes();
}

const Stats& Surface::stats() const {
  return impl_->stats;
}

}  // namespace raymap
