#include "repair/topology/unite_parts.h"

#include <cmath>
#include <utility>

#include "mesh/compact.h"
#include "mesh/diagnostics.h"
#include "mesh/unite_faces.h"
#include "repair/topology/clean_faces.h"
#include "repair/topology/mend.h"
#include "repair/topology/part_edges.h"

namespace raymap {

UnitedParts uniteParts(const Model& given, InsideOut insideOut) {
  constexpr int kMostRounds = 4;        // New vertices are rounded, so that faces may cross again.
  constexpr double kSameVolume = 1e-3;  // Share of the volume that rounding and cleaning may change.
  UnitedParts united{.mesh = weldedCopy(given)};
  if (insideOut == InsideOut::Turned) united.inverted = findInvertedParts(given);
  turnFaces(united.mesh, united.inverted.faces);
  double volume = 0.0;
  for (int round = 0; round < kMostRounds; ++round) {
    const Model mesh(united.mesh);
    const Diagnostics found = diagnose(mesh, {.brief = true});
    if (!found.balanced) return {.failure = FieldReason::Open};
    std::optional<UnitedFaces> cut = uniteFaces(mesh);
    if (!cut || cut->mesh.triangles.empty()) break;
    if (round == 0) {
      if (cut->isAnyInverted && insideOut != InsideOut::Subtracted)
        return {.failure = FieldReason::InsideOut};
      united.cutFaces += cut->cutFaces;
      volume = cut->volume;
    }
    united.mesh = cleanFaces(Model(cut->mesh), true).mesh;
    united.cutFaces += partEdges(united.mesh);
    if (!isAllRight(Model(united.mesh))) {
      raiseLowFaces(united.mesh, findSelfIntersections(united.mesh).faces);
      if (!isAllRight(Model(united.mesh))) continue;
    }
    const double made = diagnose(united.mesh, {.brief = true}).signedVolume;
    if (std::abs(made - volume) > kSameVolume * volume) break;
    return united;
  }
  return {.failure = FieldReason::Crossing};
}

}  // namespace raymap
