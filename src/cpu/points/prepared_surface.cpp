#include "cpu/points/prepared_surface.h"

#include <algorithm>
#include <cmath>

#include "cpu/backend.h"
#include "cpu/points/mark_rims.h"
#include "cpu/sign/sign.h"
#include "method/stage_times.h"

namespace raymap::cpu {

namespace {

/// Samples along the longest side of the lattice that knows the inside. About 16 triangles of an even mesh
/// touch each of its cells at the surface, within these limits.
int latticeResolution(size_t triangles) {
  constexpr double kFewest = 64.0, kMost = 96.0;
  return static_cast<int>(std::clamp(std::sqrt(double(triangles)) / 4.0, kFewest, kMost));
}

/// Farthest distance that the lattice needs to know, in samples. Points are closer to their cell's corners.
constexpr double kLatticeBand = 3.0;

/// With more rims, even a close look at the dipoles is faster.
constexpr size_t kMostRims = 16384;

/// Up to so many rims tell all sides in a compact surface: dipoles, which are faster, take as much memory as
/// half of its tree.
constexpr size_t kRimsOfCompact = 1024;

Frames framesOf(const SurfaceOptions& options) {
  return options.compact ? Frames::Made : Frames::Stored;
}

WindingLattice makeLattice(const Grid& grid, double threshold, Field& samples) {
  WindingLattice lattice;
  lattice.grid = grid;
  lattice.distance = std::move(samples.distance);
  const auto scale = static_cast<float>(1.0 / grid.spacing);
  for (float& distance : lattice.distance) distance = std::abs(distance) * scale;
  lattice.winding = std::move(samples.winding);
  lattice.agreement = std::move(samples.confidence);
  for (size_t s = 0; s < lattice.agreement.size(); ++s) {
    const float margin = marginOf(lattice.winding[s], static_cast<float>(threshold));
    lattice.agreement[s] =
        margin > 0.0f ? std::min(lattice.agreement[s] / margin, 1.0f) : 0.5f;  // Then it is not known.
  }
  return lattice;
}

/// Builds a tree of the faces as the sign takes them, if that differs from the other tree.
void turnFaces(PreparedSurface& surface) {
  const Turns& turns = surface.turns;
  const std::span<const glm::uvec3> given = surface.mesh.triangles;
  const bool isAsGiven = std::ranges::all_of(turns, [](uint8_t turn) { return turn == kAsGiven; });
  if (isAsGiven && surface.tree.triangleCount() == given.size()) {
    surface.turns.clear();
    return;
  }
  surface.turnedTriangles = turnedTriangles(given, turns);
  CellMesh cells;
  toCellUnits(surface.turnedMesh(), surface.grid, cells);
  surface.turnedTree.emplace().build(cells, surface.tree.frames());
  surface.turnedTree->releaseScratch();
}

/// Finds the rims of the faces as the sign takes them, and prepares what tells how they change winding
/// numbers.
void prepareRims(const Model& given, PreparedSurface& surface) {
  const Model turned(surface.turnedMesh()), &mesh = surface.turnedTriangles.empty() ? given : turned;
  const std::vector<RimEdge>& edges = mesh.rims(surface.grid.spacing);
  surface.lattice.isNearRim = markRims(mesh, edges, surface.grid);
  size_t count = 0;
  for (const RimEdge& edge : edges) count += edge.times;
  if (count <= (surface.tree.frames() == Frames::Made ? kRimsOfCompact : kFewRims))
    surface.dipoles = {};
  else if (surface.turnedTree || !surface.dipoles.isPrepared())
    surface.dipoles.prepare(surface.signTree());
  std::vector<RimLine> rims;
  for (const RimEdge& edge : edges)
    rims.insert(rims.end(), edge.times, RimLine{mesh.vertices[edge.from], mesh.vertices[edge.to]});
  surface.rims = WindingRims(rims);
}

/// Makes a field on the lattice, and keeps what points need of it.
PreparedSurface prepareSigned(const Model& mesh, const Grid& grid, const SurfaceOptions& options,
                              const MachineOptions& machine, Progress& progress, Stats& stats) {
  FieldOptions field;
  field.orientation = options.orientation;
  field.threshold = options.threshold;
  field.winding = field.confidence = true;
  field.band = kLatticeBand;
  PreparedSurface surface;
  std::optional<Backend> backend(std::in_place, surface.tree, surface.dipoles);
  Field samples;
  stats = backend->run({mesh, grid, field, progress, samples, machine}, framesOf(options));
  progress.stage("tree", [&] {
    surface.mesh = mesh;
    surface.grid = grid;
    surface.isSigned = true;
    surface.threshold = options.threshold;
    surface.lattice = makeLattice(grid, options.threshold, samples);
    surface.turns = backend->faceSides().turns;
    backend->restoreTree();
    backend.reset();
    turnFaces(surface);
    prepareRims(mesh, surface);
  });
  return surface;
}

}  // namespace

WindingSource PreparedSurface::windingSource() const {
  static const WindingRims kNone;
  const WindingRims& rimsOfSign = rims.count() <= kMostRims ? rims : kNone;
  return {mesh, turns, signTree(), rimsOfSign, dipoles, lattice, threshold};
}

PackedMesh PreparedSurface::turnedMesh() const {
  if (turnedTriangles.empty()) return mesh;
  return {mesh.vertices, turnedTriangles, mesh.origin};
}

size_t PreparedSurface::bytes() const {
  return tree.bytes() + (turnedTree ? turnedTree->bytes() : 0) + turns.capacity() +
         turnedTriangles.capacityBytes() + dipoles.bytes() + rims.bytes() + lattice.distance.capacityBytes() +
         lattice.winding.capacityBytes() + lattice.agreement.capacityBytes() +
         lattice.isNearRim.capacityBytes();
}

PreparedSurface prepareUnsigned(const PackedMesh& mesh, const Grid& grid, Frames frames) {
  PreparedSurface surface;
  surface.mesh = mesh;
  surface.grid = grid;
  CellMesh cells;
  toCellUnits(mesh, grid, cells);
  surface.tree.buildSingleSided(cells, frames);
  surface.tree.releaseScratch();
  return surface;
}

PreparedSurface prepareSurface(const Model& mesh, const SurfaceOptions& options,
                               const MachineOptions& machine, Progress& progress, Stats& stats) {
  const Box box = bounds(MeshView(mesh));
  const Grid grid = fitGrid(box, {.resolution = latticeResolution(mesh.triangles.size())});
  PreparedSurface surface;
  if (options.sign != SignMode::None) {
    surface = prepareSigned(mesh, grid, options, machine, progress, stats);
  } else {
    progress.stage("tree", [&] { surface = prepareUnsigned(mesh, grid, framesOf(options)); });
    stats.device = "cpu";
  }
  surface.bounds = box;
  stats.stages.clear();
  addStages(progress, stats);
  return surface;
}

PreparedSurface prepareTurned(const PackedMesh& mesh, const Turns& turns, double threshold,
                              const MachineOptions& machine, Progress& progress) {
  const SurfaceOptions options{.orientation = Orientation::Keep, .threshold = threshold};
  Buffer<glm::uvec3> triangles = turnedTriangles(mesh.triangles, turns);
  const Model turned(PackedMesh(mesh.vertices, triangles, mesh.origin));
  Stats stats;
  PreparedSurface surface = prepareSurface(turned, options, machine, progress, stats);
  surface.mesh = mesh;
  surface.turns = turns;
  surface.turnedTriangles = std::move(triangles);
  return surface;
}

}  // namespace raymap::cpu
