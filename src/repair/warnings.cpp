#include "repair/warnings.h"

#include <raymap/verdict.h>

#include <algorithm>
#include <string>

#include "base/text.h"
#include "mesh/pieces.h"
#include "repair/repair_grid.h"

namespace raymap {

namespace {

constexpr double kNotableGrowth = 1e-3;  // A smaller share of the mesh's area needs no warning.
constexpr double kMostAdvised = 4.0 * double(kMostRepairSamples);  // Of a grid that a warning recommends.

/// Returns the number of solids that lie in cavities.
size_t countLoose(const Mesh& mesh) {
  Pieces found = findPieces(Model(mesh));
  nestPieces(mesh, 1, found);
  return size_t(std::ranges::count_if(
      found.pieces, [](const Piece& piece) { return !piece.isCavity() && piece.around != Piece::kNone; }));
}

/// The farthest that a mesh reaches beyond a box.
struct Overshoot {
  double length = 0.0;
  int axis = 0;
  bool isHigh = false;
};

Overshoot overshootOf(const Box& made, const Box& allowed) {
  Overshoot most;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool isHigh : {false, true})
      if (const double length =
              isHigh ? made.max[axis] - allowed.max[axis] : allowed.min[axis] - made.min[axis];
          length > most.length)
        most = {length, axis, isHigh};
  return most;
}

glm::dvec3 farthest(const Mesh& mesh, const Overshoot& excess) {
  const auto farthest = std::ranges::max_element(mesh.vertices, {}, [&](const glm::vec3& p) {
    return excess.isHigh ? p[excess.axis] : -p[excess.axis];
  });
  return mesh.origin + glm::dvec3(*farthest);
}

}  // namespace

void warnOfSheet(const Diagnostics& found, const RepairOptions& repair, const WarningCallback& warn) {
  const Verdict verdict = judge(found, {});
  if (verdict.remedy != Remedy::Thicken || repair.base || repair.minThickness) return;
  warn({WarningCode::Sheet,
        "the mesh is a sheet, an open surface without a definite inside, so the solid is a guess; give it a "
        "thickness, such as " +
            numberText(verdict.thickness, 3) + ", or join its rim to a flat base",
        {.length = verdict.thickness}});
}

void warnOfBounds(const PackedMesh& mesh, const Mesh& result, const Grid& grid, const RepairOptions& repair,
                  bool isCut, const WarningCallback& warn) {
  if (result.triangles.empty()) return;
  const Box box = bounds(mesh);
  const double plate = 0.5 * repair.minThickness.value_or(0.0) + grid.spacing;
  const double outwards = std::max(repair.offset, 0.0), allowed = std::max(2.0 * grid.spacing, plate);
  const Overshoot excess = overshootOf(bounds(result), {box.min - outwards, box.max + outwards});
  if (excess.length <= allowed && !isCut) return;
  const glm::dvec3 at = farthest(result, excess);
  const std::string side = std::string(excess.isHigh ? "highest " : "lowest ") + "xyz"[excess.axis];
  warn({WarningCode::BoundsLeft,
        "the result reaches " + numberText(excess.length, 3) + " beyond the mesh's " + side + ", at (" +
            numberText(at.x, 6) + ", " + numberText(at.y, 6) + ", " + numberText(at.z, 6) +
            "), where it closes a hole" +
            (isCut ? ", and would reach farther if it were not cut off there" : "") +
            "; close this hole in the mesh if it should be flat, or give open surface a thickness",
        {.length = excess.length}});
}

void warnOfThickened(const PackedMesh& mesh, const Thickened& thickened, const RepairOptions& repair,
                     double thickness, const WarningCallback& warn) {
  if (repair.minThickness || thickened.grownShare < kNotableGrowth) return;
  const double voxelSize = roundDown(0.5 * thickened.thinnest);
  const glm::dvec3 samples = samplesFor(bounds(mesh), voxelSize);
  const double count = samples.x * samples.y * samples.z;
  const bool isPossible = count <= kMostAdvised;
  warn({WarningCode::PartsThickened,
        numberText(100.0 * thickened.grownShare, 3) + " % of the mesh's surface is on walls about " +
            numberText(thickened.median, 3) + " thick, which are " + numberText(thickness, 3) +
            " thick now; a voxel size of " + numberText(voxelSize, 3) + " keeps them, with " +
            numberText(count, 2) + " samples" +
            (isPossible ? "" : ", which is too many: repair parts of the mesh apart from each other"),
        {.share = thickened.grownShare, .length = thickness, .voxelSize = isPossible ? voxelSize : 0.0}});
}

void warnOfLooseBodies(const Mesh& before, const Mesh& result, const WarningCallback& warn) {
  const size_t loose = countLoose(result), known = countLoose(before);
  if (loose <= known) return;
  const size_t count = loose - known;
  warn(
      {WarningCode::LooseBodies,
       std::to_string(count) + (count == 1 ? " body lies" : " bodies lie") +
           " loose in the hollow: the walls around sealed cavities that were kept; fill the cavities instead",
       {.count = count}});
}

void warnOfHoles(const RepairReport& report, const RepairOptions& repair, const WarningCallback& warn) {
  if (const size_t filled = report.filledHollows; filled > 0)
    warn({WarningCode::HollowsFilled,
          std::to_string(filled) + (filled == 1 ? " hollow is" : " hollows are") +
              " too small for the drain hole and stayed solid; use a smaller drain hole",
          {.count = filled}});
  else if (report.hollows == 0)
    warn({WarningCode::NoHollow,
          "the solid is nowhere thick enough for a hollow inside its walls, so it has none; use thinner "
          "walls"});
  if (repair.drainHole == 0.0) return;
  if (const size_t asked = report.hollows * size_t(repair.drainHoles); report.drainHoles < asked)
    warn({WarningCode::DrainHolesMissing,
          "only " + std::to_string(report.drainHoles) + " of " + std::to_string(asked) +
              " drain holes were made, because the level floors of the hollows have no place for more",
          {.count = asked - report.drainHoles}});
}

}  // namespace raymap
