#include "api/field_warnings.h"

#include <raymap/diagnostics.h>

#include <cmath>
#include <string>

#include "base/text.h"

namespace raymap {

namespace {

/// Returns whether the cells of the grid hold the box.
bool holds(const Grid& grid, const Box& box) {
  constexpr double kHalfCell = 0.5 + 1e-6;  // A box may be what the grid was fitted to.
  const glm::dvec3 low = grid.position(glm::dvec3(-kHalfCell));
  const glm::dvec3 high = grid.position(glm::dvec3(grid.dims - 1) + kHalfCell);
  return glm::all(glm::lessThanEqual(low, box.min)) && glm::all(glm::lessThanEqual(box.max, high));
}

}  // namespace

void warnOfMisfit(const Stats& stats, const WarningCallback& warn) {
  if (warn && !stats.orientationFits)
    warn({WarningCode::OrientationMisfit,
          "no directions of the faces fit the crossings, misfit " + numberText(stats.misfit, 3) +
              ", so signs may be wrong; find out what is wrong with the mesh, and mend it",
          {.share = stats.misfit}});
}

void warnOfNothingInside(const PackedMesh& mesh, const Grid& grid, const MachineOptions& machine) {
  if (!machine.warn || !holds(grid, bounds(mesh))) return;
  const Diagnostics found = diagnose(mesh, {.brief = true}, {.threads = machine.threads});
  const double spacing = grid.spacing;
  const std::string begin = "no sample is inside, because ";
  // A plate has half of its thickness as volume over area.
  const double finer = found.balanced ? std::abs(found.signedVolume) / found.area : 0.0;
  constexpr double kSheet = 0.03;  // Share of the spacing; below it, samples would be too many.
  if (finer > kSheet * spacing && finer < spacing) {
    const double voxelSize = roundDown(finer);
    machine.warn({WarningCode::NothingInside,
                  begin + "the mesh is thinner than the spacing " + numberText(spacing, 3) +
                      "; use a spacing of " + numberText(voxelSize, 3),
                  {.voxelSize = voxelSize}});
    return;
  }
  const double thickness = 2.0 * spacing;
  machine.warn({WarningCode::NothingInside,
                begin + "the faces enclose nothing at the spacing " + numberText(spacing, 3) +
                    "; make a solid around its surface, with a thickness of " + numberText(thickness, 3) +
                    ", or use a smaller spacing",
                {.length = thickness}});
}

}  // namespace raymap
