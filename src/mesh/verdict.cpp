#include <raymap/verdict.h>

namespace raymap {

namespace {

/// Returns whether a component has four faces at most on average, and most of their edges are free.
bool isSoup(const Diagnostics& found) {
  return found.components > 1 && 4 * found.components >= found.triangles &&
         found.boundaryEdges > found.triangles;
}

/// Returns the kind of a closed surface whose faces agree.
MeshKind kindOfClosed(const Diagnostics& found, size_t crossingPairs) {
  if (crossingPairs > 0) return found.components > 1 ? MeshKind::OverlappingSolids : MeshKind::CrossingSolid;
  if (found.nonManifoldEdges + found.degenerateFaces + found.duplicateFaces > 0) return MeshKind::FlawedSolid;
  if (found.inwardComponents == found.components) return MeshKind::InsideOut;
  return found.components - found.inwardComponents > 1 ? MeshKind::SeveralSolids : MeshKind::CleanSolid;
}

MeshKind kindOf(const Diagnostics& found, size_t crossingPairs) {
  if (found.area == 0.0) return MeshKind::NoSurface;
  if (isDoubleSided(found)) return MeshKind::DoubleSided;
  if (isSoup(found)) return MeshKind::Soup;
  if (found.sheetShare > 0.5) return MeshKind::Sheet;
  if (found.boundaryEdges > 0) return MeshKind::OpenSolid;
  if (found.flippedEdges > 0) return MeshKind::TurnedFaces;
  return kindOfClosed(found, crossingPairs);
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

}  // namespace

Verdict judge(const Diagnostics& found, const std::optional<SelfIntersections>& crossings) {
  const MeshKind kind = kindOf(found, crossings ? crossings->pairs : 0);
  return {.kind = kind, .remedy = remedyFor(kind, found)};
}

}  // namespace raymap
