#pragma once

#include <raymap/diagnostics.h>

#include <cstdint>
#include <functional>

#include "base/progress.h"
#include "mesh/packed_mesh.h"

namespace raymap {

/// Two faces that cross, or overlap in one plane.
struct FacePair {
  uint32_t a, b;
  bool isInPlane;
};
using VisitPair = std::function<void(const FacePair&)>;

/// Visits all pairs that `findSelfIntersections` counts, one after the other and always in the same order.
/// Returns false if the search stopped early.
bool forEachMeetingPair(const PackedMesh& mesh, const VisitPair& visit, Progress& progress);

/// Does the same for all pairs that cross, overlap in one plane, repeat each other, or may touch outside of
/// common corners and edges. Faces without area are in none.
bool forEachTouchingPair(const PackedMesh& mesh, const VisitPair& visit, Progress& progress);

}  // namespace raymap
