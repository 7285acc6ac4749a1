#include "repair/topology/unite_parts.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <raymap/field.h>

#include "mesh/compact.h"
#include "mesh/diagnostics.h"
#include "mesh/unite_faces.h"
#include "repair/topology/clean_faces.h"
#include "repair/topology/mend.h"
#include "repair/topology/part_edges.h"
#include "repair/topology/sew_cracks.h"

namespace raymap {

UnitedParts uniteParts(const Model& given, InsideOut insideOut, bool closesHoles) {
  constexpr int kMostRounds = 4;        // New vertices are rounded, so that faces may cross again.
  constexpr double kSameVolume = 1e-3;  // Share of the volume that rounding and cleaning may change.
  UnitedParts united{.mesh = weldedCopy(given)};
  std::vector<uint32_t> faces;  // Of the given mesh, if some were left out.
  std::vector<uint32_t> back;   // Faces that contradict their part.
  if (!diagnose(united.mesh, {.brief = true}).balanced) {
    CleanedFaces cleaned = cleanFaces(given);
    united.mesh = std::move(cleaned.mesh);
    faces = std::move(cleaned.given);
    united.cleanedFaces = cleaned.count;
    bool isConsistent = diagnose(united.mesh, {.brief = true}).consistentlyOriented;
    if (!isConsistent && insideOut == InsideOut::Turned) {
      back = turnBack(united.mesh);
      isConsistent = !back.empty();
    }
    if (closesHoles) united.sewnVertices = sewCracks(united.mesh);
    if (const Diagnostics found = diagnose(united.mesh); !found.balanced) {
      if (found.sheets > 0) return {.failure = FieldReason::Sheet};
      // Between faces that contradict each other is no hole, unless a crack was between them.
      if (closesHoles && isConsistent && (insideOut == InsideOut::Turned || found.consistentlyOriented))
        united.filled = fillHoles(united.mesh);
      if (united.filled.holes == 0) return {.failure = FieldReason::Open};
    }
  }
  if (insideOut == InsideOut::Turned) united.inverted = findInvertedParts(united.mesh);
  turnFaces(united.mesh, united.inverted.faces);
  for (uint32_t f = 0; f < united.mesh.triangles.size(); ++f)
    united.sources.push_back(faces.empty() ? f : f < faces.size() ? faces[f] : kNoTriangle);
  double volume = 0.0;
  size_t pairs = SIZE_MAX;  // Of crossing faces, after the round before.
  for (int round = 0; round < kMostRounds; ++round) {
    const Model mesh(united.mesh);
    std::optional<UnitedFaces> cut = uniteFaces(mesh, insideOut != InsideOut::Subtracted);
    if (!cut || cut->mesh.triangles.empty()) break;
    if (round == 0) {
      std::vector<uint32_t> inverted;
      std::ranges::set_symmetric_difference(united.inverted.faces, cut->turned, std::back_inserter(inverted));
      std::ranges::set_symmetric_difference(back, inverted, std::back_inserter(united.turned));
      std::erase_if(united.turned, [&](uint32_t f) { return !faces.empty() && f >= faces.size(); });
      if (!faces.empty()) united.turned = facesOf(united.turned, faces);
      united.cutFaces += cut->cutFaces;
      united.buriedShare = cut->buriedShare;
      volume = cut->volume;
    }
    CleanedFaces cleaned = cleanFaces(Model(cut->mesh), true);
    united.mesh = std::move(cleaned.mesh);
    for (uint32_t& f : cleaned.given) f = united.sources[cut->sources[f]];
    united.sources = std::move(cleaned.given);
    united.cutFaces += partEdges(united.mesh, united.sources);
    if (!isAllRight(Model(united.mesh))) {
      const SelfIntersections crossing = findSelfIntersections(united.mesh);
      if (crossing.pairs > pairs) break;  // Rounding makes ever more.
      pairs = crossing.pairs;
      raiseLowFaces(united.mesh, crossing.faces);
      if (!isAllRight(Model(united.mesh))) continue;
    }
    const double made = diagnose(united.mesh, {.brief = true}).signedVolume;
    if (std::abs(made - volume) > kSameVolume * volume) break;
    return united;
  }
  return {.failure = FieldReason::Crossing};
}

}  // namespace raymap
