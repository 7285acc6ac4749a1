#include "repair/run.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace raymap {

namespace {

/// Returns the band of samples around the surface that a repair reads; 0 = all samples. Hollows read how deep
/// the samples lie. Where holes stay open, the sign jumps between samples that are far from the surface.
double neededBand(const Grid& grid, const RepairOptions& repair) {
  constexpr double kBeside = 4.0;  // The isosurface and thin parts read samples beside the moved surface.
  if (repair.shell > 0.0 || !repair.closeHoles) return 0.0;
  return kBeside + std::abs(repair.offset) / grid.spacing;
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

void RepairRun::makeSolid() {
  FieldOptions how = fieldOptions;
  how.closeHoles = options.closeHoles;
  how.band = neededBand(grid, options);
  auto [field, cost] = generator_.generate(mesh(), grid, how, machine);
  turns_ = turnsOf(cost, mesh().triangles.size());
  cost.turnedFaces = allTurned(report.stats.turnedFaces, std::move(cost.turnedFaces), given.triangles.size());
  report.stats = std::move(cost);
  solid = std::move(field);
  for (float& d : solid.distance) d = static_cast<float>(double(d) - options.offset);
}

void RepairRun::makeSolidAgain() {
  FieldOptions how = fieldOptions;
  how.orientation = Orientation::Keep;
  solid = fieldOf(result, how);
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
