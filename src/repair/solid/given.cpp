#include "repair/solid/given.h"

#include <cmath>

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

}  // namespace

Generated Given::generateSolid() {
  FieldOptions solid = options;
  solid.closeHoles = repair.closeHoles;
  solid.band = neededBand(grid, repair);
  Generated made = generator_.generate(mesh, grid, solid, machine);
  turns_ = turnsOf(made.stats, mesh.triangles.size());
  return made;
}

Field Given::generateOther(const MeshView& other, const FieldOptions& different) {
  return generator_.generate(other, grid, different, machine).field;
}

const cpu::PreparedSurface& Given::surface() {
  if (!surface_) {
    Progress progress(machine.progress);
    surface_ = cpu::prepareTurned(mesh, turns_, options.threshold, machine, progress);
  }
  return *surface_;
}

}  // namespace raymap
