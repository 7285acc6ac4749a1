#include "api/field_warnings.h"

#include <raymap/diagnostics.h>

#include <algorithm>
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
          "the faces contradict each other, whichever way each of them points, so signs may be wrong; find "
          "out what is wrong with the mesh, and mend it",
          {.share = stats.misfit}});
}

void warnOfInvertedParts(const Stats& stats, const WarningCallback& warn) {
  constexpr size_t kMostNamed = 8;
  const std::vector<uint32_t>& parts = stats.invertedParts;
  if (!warn || parts.empty()) return;
  std::string names;
  for (size_t p = 0; p < std::min(parts.size(), kMostNamed); ++p)
    names += (p > 0 ? ", " : "") + std::to_string(parts[p]);
  if (parts.size() > kMostNamed) names += ", ...";
  const bool isOne = parts.size() == 1;
  warn({WarningCode::PartsInsideOut,
        std::to_string(parts.size()) + (isOne ? " part (with face " : " parts (with faces ") + names +
            (isOne ? ") is inside out and crosses others, so the sign reverses it"
                   : ") are inside out and cross others, so the sign reverses them") +
            "; keep the faces' directions if that is meant",
        {.count = parts.size()}});
}

void warnOfNothingInside(const PackedMesh& mesh, const Grid& grid, const MachineOptions& machine) {
  if (!machine.warn || !holds(grid, gridBounds(mesh))) return;
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
