#include "repair/run.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "api/field_warnings.h"
#include "cpu/points/narrow_band.h"
#include "repair/solid/solid_band.h"
#include "repair/stages.h"
#include "repair/topology/clean_faces.h"

namespace raymap {

namespace {

/// Returns the widths of the band of samples around the surface that a repair reads.
BandOptions neededBand(const Grid& grid, const RepairOptions& repair) {
  constexpr double kBeside = 4.0;  // The isosurface and thin parts read samples beside the moved surface.
  const double offset = std::abs(repair.offset) / grid.spacing,
               radius = 0.5 * repair.drainHole / grid.spacing;
  // A hole ends outside, where its end is free. Hollows less deep than its radius are filled.
  return {.outside = offset + std::max(kBeside, radius + 1.0),
          .inside = offset + kBeside + radius + repair.shell / grid.spacing};
}

Turns turnsOf(const Stats& stats, size_t faces) {
  if (stats.turnedFaces.empty() && stats.leftOutFaces.empty()) return {};
  Turns turns(faces, kAsGiven);
  for (const uint32_t face : stats.turnedFaces) turns[face] = kReversed;
  for (const uint32_t face : stats.leftOutFaces) turns[face] = kLeftOut;
  return turns;
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

}  // namespace

RepairRun::RepairRun(const MeshView& mesh, const Grid& lattice, const FieldOptions& signOptions,
                     const RepairOptions& changes, const MachineOptions& machineOptions)
    : given(mesh),
      grid(lattice),
      fieldOptions(signOptions),
      options(changes),
      machine(machineOptions),
      progress(machineOptions.progress) {
  machine.warn = [this, warn = machineOptions.warn](const Warning& warning) {
    // Repair says itself what its fields lack, and how far its result reaches.
    isCut = isCut || warning.code == WarningCode::BoxReached;
    if (warning.code == WarningCode::NothingInside || warning.code == WarningCode::BoxReached) return;
    report.warnings.push_back(warning);
    if (warn) warn(warning);
  };
}

bool RepairRun::isDense() const {
  constexpr size_t kMostSamples = size_t{1} << 24;  // They take some 20 bytes each.
  if (needsAllSamples(machine) || fieldOptions.sign != SignMode::Harmonic ||
      fieldOptions.distance != DistanceMode::Exact)
    return true;
  // Points in an open mesh find their winding numbers one by one, a grid those of all its samples together.
  return options.shell == 0.0 && grid.sampleCount() <= std::min(kMostSamples, most() / kBytesPerSample) &&
         !diagnose(mesh(), {.brief = true}).balanced;
}

void RepairRun::makeSolid() {
  if (isDense()) {
    FieldOptions how = fieldOptions;
    how.closeHoles = options.closeHoles;
    // The sign jumps far from the surface where holes stay open.
    const BandOptions band = neededBand(grid, options);
    how.band = options.closeHoles ? std::max(band.outside, band.inside) : 0.0;
    makeDense(how);
  } else {
    makeBand();
  }
  for (float& d : solid.distance) d = static_cast<float>(double(d) - options.offset);
}

void RepairRun::makeDense(const FieldOptions& how) {
  auto [field, cost] = generator_.generate(mesh(), grid, how, machine);
  turns_ = turnsOf(cost, mesh().triangles.size());
  take(std::move(cost));
  solid = std::move(field);
}

void RepairRun::makeBand() {
  Stats stats;
  withThreads(machine.threads, [&] {
    const SurfaceOptions how{.orientation = fieldOptions.orientation, .threshold = fieldOptions.threshold};
    surface_ = cpu::prepareSurface(Model(mesh()), how, machine, progress, stats);
    ClosedBand closed =
        makeClosedBand(*surface_, grid, neededBand(grid, options), options.closeHoles, most(), progress);
    stats.patchTriangles = closed.patchTriangles;
    stats.patchArea = closed.patchArea;
    solid = std::move(closed.field);
  });
  stats.bytes = std::max(stats.bytes, surface_->bytes() + solid.bytes());
  stats.stages.clear();  // They are added in the end.
  take(std::move(stats));
  solid.narrow->outside -= options.offset;
  solid.narrow->inside += options.offset;
  warnOfMisfit(report.stats, machine.warn);
  warnOfInvertedParts(report.stats, machine.warn);
}

void RepairRun::take(Stats stats) {
  std::vector<uint32_t> inverted = std::move(report.stats.invertedParts);
  if (!kept.rest.empty()) {
    stats.turnedFaces = facesOf(stats.turnedFaces, kept.rest);
    stats.invertedParts = facesOf(stats.invertedParts, kept.rest);
  }
  stats.turnedFaces =
      allTurned(report.stats.turnedFaces, std::move(stats.turnedFaces), given.triangles.size());
  stats.invertedParts.insert(stats.invertedParts.end(), inverted.begin(), inverted.end());
  std::ranges::sort(stats.invertedParts);
  report.stats = std::move(stats);
}

void RepairRun::makeSolidAgain() {
  solid = {};
  const cpu::PreparedSurface left = cpu::prepareTurned(result, {}, fieldOptions.threshold, machine, progress);
  solid = cpu::makeNarrowBand(left, grid, neededBand(grid, options), most(), progress);
}

Field RepairRun::fieldOf(const MeshView& other, const FieldOptions& different) {
  return generator_.generate(other, grid, different, machine).field;
}

const cpu::PreparedSurface& RepairRun::surface() {
  if (!surface_) {
    Progress untold(machine.progress);
    surface_ = cpu::prepareTurned(mesh(), turns_, fieldOptions.threshold, machine, untold);
  }
  return *surface_;
}

}  // namespace raymap
