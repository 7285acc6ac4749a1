// How the closed parts of a mesh lie to each other: the one test of it that verdicts and repairs use.

#include <algorithm>

#include "base/parallel.h"
#include "base/progress.h"
#include "mesh/diagnostics.h"
#include "mesh/half_edges.h"
#include "mesh/pieces.h"
#include "mesh/self_intersections.h"

namespace raymap {

namespace {

constexpr size_t kRaysPerPiece = 64;

/// How faces of different pieces meet.
struct Meetings {
  bool cross = false, overlapInPlane = false;
};

Meetings findMeetings(const PackedMesh& mesh, const Pieces& found, Progress& progress) {
  Meetings meetings;
  const auto visit = [&](const FacePair& pair) {
    if (found.ids[pair.a] != found.ids[pair.b])
      (pair.isInPlane ? meetings.overlapInPlane : meetings.cross) = true;
  };
  forEachMeetingPair(mesh, visit, progress);
  return meetings;
}

/// Returns whether all faces point the right way for what is around them: outermost pieces are solids, and
/// pieces in others are cavities in solids or solids in cavities.
bool areNestedRight(const Pieces& found) {
  return std::ranges::all_of(found.pieces, [&](const Piece& piece) {
    const bool isInSolid = piece.around != Piece::kNone && !found.pieces[piece.around].isCavity();
    return piece.isCavity() == isInSolid;
  });
}

Arrangement arrange(const Model& mesh, bool doFacesMeet, Progress& progress) {
  if (mesh.halfEdges().size() != 3 * mesh.triangles.size())
    return Arrangement::Unknown;  // Corners are repeated.
  Pieces found = findPieces(mesh);
  const bool areSeveral = found.pieces.size() > 1;
  const Meetings meetings = doFacesMeet && areSeveral ? findMeetings(mesh, found, progress) : Meetings{};
  if (meetings.cross) return Arrangement::Overlapping;
  nestPieces(mesh, kRaysPerPiece, found);
  if (found.areMixed) return Arrangement::Overlapping;
  if (meetings.overlapInPlane || found.areTouching) return Arrangement::Touching;
  if (!areNestedRight(found)) return Arrangement::Misnested;
  const bool areApart =
      std::ranges::all_of(found.pieces, [](const Piece& piece) { return piece.around == Piece::kNone; });
  return areApart ? Arrangement::Separate : Arrangement::Nested;
}

}  // namespace

Arrangement arrangeParts(const Model& mesh, const Diagnostics& diagnostics,
                         const SelfIntersections& crossings, const MachineOptions& machine) {
  if (!diagnostics.watertight || !diagnostics.consistentlyOriented) return Arrangement::Unknown;
  Progress progress(machine.progress);
  Arrangement arrangement = Arrangement::Unknown;
  progress.stage("parts", [&] {
    withThreads(machine.threads, [&] {
      arrangement = arrange(mesh, crossings.pairs + crossings.coplanarPairs > 0, progress);
    });
  });
  return arrangement;
}

Arrangement arrangeParts(const MeshView& view, const Diagnostics& diagnostics,
                         const SelfIntersections& crossings, const MachineOptions& machine) {
  validate(view);
  return arrangeParts(Model(view), diagnostics, crossings, machine);
}

}  // namespace raymap
