#include <raymap/verdict.h>

#include <algorithm>
#include <cmath>

namespace raymap {

namespace {

/// Returns whether a component has four faces at most on average, and most of their edges are free.
bool isSoup(const Diagnostics& found) {
  return found.components > 1 && 4 * found.components >= found.triangles &&
         found.boundaryEdges > found.triangles;
}

/// Returns the kind of a closed surface whose faces agree.
MeshKind kindOfClosed(const Diagnostics& found, size_t crossingPairs, Arrangement arrangement) {
  const bool isUnknown = arrangement == Arrangement::Unknown;
  const bool isInsideOut = found.inwardComponents == found.components;
  if (arrangement == Arrangement::Overlapping || (isUnknown && crossingPairs > 0 && found.components > 1))
    return MeshKind::OverlappingSolids;
  if (arrangement == Arrangement::Touching) return MeshKind::TouchingSolids;
  if (arrangement == Arrangement::Misnested && !isInsideOut) return MeshKind::MisnestedSolids;
  if (crossingPairs > 0) return MeshKind::CrossingSolid;
  if (found.nonManifoldEdges + found.degenerateFaces + found.duplicateFaces > 0) return MeshKind::FlawedSolid;
  if (isInsideOut) return MeshKind::InsideOut;
  return found.components - found.inwardComponents > 1 ? MeshKind::SeveralSolids : MeshKind::CleanSolid;
}

MeshKind kindOf(const Diagnostics& found, size_t crossingPairs, Arrangement arrangement) {
  if (found.area == 0.0) return MeshKind::NoSurface;
  if (isDoubleSided(found)) return MeshKind::DoubleSided;
  if (isSoup(found)) return MeshKind::Soup;
  if (found.sheetShare > 0.5) return MeshKind::Sheet;
  if (found.boundaryEdges > 0) return MeshKind::OpenSolid;
  if (found.flippedEdges > 0) return MeshKind::TurnedFaces;
  return kindOfClosed(found, crossingPairs, arrangement);
}

Remedy remedyFor(MeshKind kind, const Diagnostics& found) {
  switch (kind) {
    case MeshKind::NoSurface:
    case MeshKind::SeveralSolids:
    case MeshKind::CleanSolid:
      return Remedy::None;
    case MeshKind::Sheet:
      return Remedy::Thicken;
    case MeshKind::DoubleSided:
      return found.sheetShare > 0.5 ? Remedy::Thicken : Remedy::Repair;
    default:
      return Remedy::Repair;
  }
}

/// Returns a thickness for a sheet: a fiftieth of its longest side, in one digit.
double thicknessFor(const Diagnostics& found) {
  const glm::dvec3 size = found.bounds.size();
  const double thickness = std::max({size.x, size.y, size.z}) / 50.0;
  const double digit = std::pow(10.0, std::floor(std::log10(thickness)));
  return std::round(thickness / digit) * digit;
}

}  // namespace

Verdict judge(const Diagnostics& found, const std::optional<SelfIntersections>& crossings,
              Arrangement arrangement) {
  const MeshKind kind = kindOf(found, crossings ? crossings->pairs : 0, arrangement);
  const Remedy remedy = remedyFor(kind, found);
  return {.kind = kind,
          .remedy = remedy,
          .arrangement = arrangement,
          .thickness = remedy == Remedy::Thicken ? thicknessFor(found) : 0.0};
}

}  // namespace raymap
