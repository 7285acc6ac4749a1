#include <raymap/repair.h>

#include <cmath>
#include <string>
#include <utility>

#include "base/require.h"
#include "base/text.h"
#include "field/field_sampler.h"
#include "method/check_options.h"
#include "method/stage_times.h"
#include "repair/pipeline.h"

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
  const Plane cut = repair.cutPlane.value_or(Plane{});
  require(glm::length(cut.normal) > 0.0 && std::isfinite(glm::length(cut.normal) + cut.offset),
          "the plane of a cut needs finite numbers and a normal that is not zero");
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

}  // namespace

Repaired repair(const MeshView& mesh, const Grid& grid, const FieldOptions& options,
                const RepairOptions& repair, const MachineOptions& machine) {
  validateGrid(grid);
  checkOptions(options);
  check(options);
  check(grid, repair);
  RepairRun run(mesh, grid, options, repair, machine);
  runRepair(run);
  addStages(run.progress, run.report.stats);
  return std::move(run.repaired);
}

}  // namespace raymap
